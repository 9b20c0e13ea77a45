#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "edit/edit_tables.h"
#include "retarget/edit.h"
#include "retarget/options.h"

namespace retarget::cli {

/// What `retarget edit` does.
enum class Edit : unsigned char {
  kRest,      ///< Another rest pose, the same movement.
  kTransfer,  ///< Another skeleton, through the T-pose.
  kLafan1,    ///< LAFAN1's shape.
  kResample,  ///< Another frame rate or speed.
  kTrim,      ///< A part of the clip.
  kMirror,    ///< Left does what right did.
  kGround,    ///< The floor at height 0.
  kTurn,      ///< About the vertical.
  kMove,      ///< Over the ground.
  kLoop,      ///< A cycle without a seam.
  kConcat,    ///< Several clips as one.
  kPath,      ///< The way over the ground.
};

/// `retarget edit`: BVH in, BVH out.
struct EditArguments : EditSettings {
  CommonArguments common;
  std::string file;
  SourceOptions source;
  HumanOptions human;
  std::string write_map;
  Edit edit = Edit::kRest;
  PartOptions part{};
  std::string like;                ///< BVH with the target skeleton.
  double degrees = 0.0;            ///< Of a turn.
  std::string shift;               ///< Of a move, `X,Y` in metres.
  std::vector<std::string> files;  ///< That are joined.
  std::string matrix;              ///< PGM to write; empty: none.
  std::string fit;                 ///< JSON to write; empty: none.
  std::string svg;                 ///< Picture to write; empty: none.
  std::string output;
};

}  // namespace retarget::cli
