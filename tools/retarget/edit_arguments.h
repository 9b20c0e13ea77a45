#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
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
struct EditArguments {
  CommonArguments common;
  std::string file;
  SourceOptions source;
  HumanOptions human;
  std::string write_map;
  Edit edit = Edit::kRest;
  PartOptions part{};
  std::string like;             ///< BVH with the target skeleton.
  double degrees = 0.0;         ///< Of a turn.
  std::string shift;            ///< Of a move, `X,Y` in metres.
  std::optional<double> floor;  ///< Its height, metres; nothing: found.
  std::string fps;              ///< Of TimingOptions::rate; empty: not given.
  TimingOptions timing;
  Interpolation interpolation = Interpolation::kCubic;
  bool no_antialias = false;
  LoopOptions loop;
  std::vector<std::string> files;  ///< That are joined.
  std::string search;              ///< Seconds, or `all`; empty: 2, and more without a good seam.
  ConcatenateOptions concat;
  std::string matrix;          ///< PGM to write; empty: none.
  double threshold_cm = 20.0;  ///< Of a seam.
  bool force = false;
  PathChange path;
  FollowPathOptions follow_path;
  std::string fit;  ///< JSON to write; empty: none.
  std::string svg;  ///< Picture to write; empty: none.
  std::string output;
};

}  // namespace retarget::cli
