#pragma once

#include <string>
#include <vector>

#include "options.h"

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

/// Which part of a clip is meant.
struct PartOptions {
  double start_s = -1.0;  ///< Negative: not given.
  double end_s = -1.0;
  std::string frames;  ///< `a:b`; empty: not given.
};

/// `retarget edit resample`.
struct TimingOptions {
  std::string fps;     ///< Empty: not given.
  double speed = 0.0;  ///< 0: not given.
  std::string interpolation = "cubic";
  bool no_antialias = false;
};

/// `retarget edit loop`.
struct CycleOptions {
  double shortest_s = 0.0;  ///< 0: half the clip.
  bool in_place = false;
  int times = 1;
  double threshold_cm = 20.0;
  bool force = false;
};

/// `retarget edit concat`.
struct SeamCliOptions {
  std::vector<std::string> files;
  std::string search;  ///< Seconds, or `all`; empty: 2, and more where that gives no good seam.
  double window_s = 1.0 / 3.0;
  std::string blend = "crossfade";
  double threshold_cm = 20.0;
  bool force = false;
  std::string matrix;  ///< PGM to write; empty: none.
};

/// `retarget edit path`.
struct PathCliOptions {
  std::string fit;      ///< JSON to write; empty: none.
  std::string svg;      ///< Picture to write; empty: none.
  std::string to;       ///< JSON, or the name of a ready path; empty: the clip's own.
  double radius = 3.0;  ///< Of a circle, metres; negative: to the right.
  double scale = 1.0;
  double rotate_deg = 0.0;
  std::string keep = "time";
  double tolerance = 0.05;  ///< Metres.
};

/// `retarget edit`: BVH in, BVH out.
struct EditOptions {
  CommonOptions common;
  SourceOptions source;
  HumanOptions human;
  Edit edit = Edit::kRest;
  PartOptions part;
  std::string like;    ///< BVH of the skeleton that is wanted.
  std::string amount;  ///< Degrees of a turn, `X,Y` in metres of a move.
  std::string floor;   ///< Height of the floor, metres; empty: found.
  TimingOptions timing;
  CycleOptions cycle;
  SeamCliOptions concat;
  PathCliOptions path;
  std::string output;
};

}  // namespace retarget::cli
