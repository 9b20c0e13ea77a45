#pragma once

#include <string>
#include <vector>

#include "arguments.h"
#include "retarget/edit_tables.h"
#include "retarget/options.h"

namespace retarget::cli {

/// Subcommands of `retarget edit`.
enum class Edit : unsigned char {
  kRest,      ///< Another rest pose, the same movement.
  kTransfer,  ///< Another skeleton, through the T-pose.
  kLafan1,    ///< LAFAN1's skeleton.
  kResample,  ///< Another frame rate or speed.
  kTrim,      ///< A part of the clip.
  kMirror,    ///< Left and right exchanged.
  kGround,    ///< The floor at height 0.
  kTurn,      ///< Rotation about the vertical.
  kMove,      ///< Translation over the ground.
  kLoop,      ///< A seamless cycle.
  kConcat,    ///< Several clips joined.
  kPath,      ///< Another path over the ground.
};

/// Arguments of `retarget edit`, which reads and writes BVH.
struct EditArguments : EditSettings {
  CommonArguments common;
  std::string file;
  SourceOptions source;
  HumanOptions human;
  std::string write_map;
  Edit edit = Edit::kRest;
  PartOptions part{};
  std::string like;                ///< BVH with the target skeleton.
  double degrees = 0.0;            ///< Rotation angle of a turn.
  std::string shift;               ///< Translation of a move, `X,Y` in metres.
  std::vector<std::string> files;  ///< Clips to join.
  std::string matrix;              ///< PGM to write; empty: none.
  std::string fit;                 ///< JSON to write; empty: none.
  std::string svg;                 ///< Picture to write; empty: none.
  std::string output;
};

}  // namespace retarget::cli
