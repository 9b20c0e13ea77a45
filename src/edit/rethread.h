#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edit/concatenate.h"
#include "edit/fit_path.h"
#include "edit/plant_feet.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// What stays as it is when a path becomes longer or shorter.
enum class PathKeep : std::uint8_t {
  kTime,    ///< How long the motion takes: all of the path is gone in it.
  kSpeed,   ///< How fast it goes: it is played slower on a longer path.
  kStride,  ///< How far each frame is along the path: the motion ends where its own way is gone,
            ///< or goes straight on from the path's end.
};

struct RethreadOptions {
  PathKeep keep = PathKeep::kTime;
  PathFitOptions fit;
  PlantOptions plant;
  double same_stand = 0.1;  ///< Contacts of a foot with a shorter break are one, seconds.
  MotionLimits limits;      ///< Of the joints.
};

/// A motion on another path.
struct Rethreaded {
  Clip clip;
  PathMotion source;               ///< The motion's own path.
  std::vector<GroundPose> frames;  ///< That move along the new path, per frame of the source.
  PlantSummary feet;
  SeamCheck check;  ///< Speeds and accelerations in the whole clip; faults where a path hurries.
};

/// Sends a motion along another path: the body keeps its pose relative to the frame that moves
/// along the path (place and tangent), so the body at s(t) on its own path moves by
/// F'(s'(t)) F(s(t))^-1. Corners of a path are turned at no more than 4 rad/s (spread_turns). Only
/// the channels that move the whole body change; then feet that stand are planted where the frame
/// in the middle of each contact brings them (plant_feet).
///
/// @param file  for messages.
/// @return kInput errors as fit_path and BodyMover::of; kUsage errors: kSpeed for a motion without
///     a way of its own, or for a path more than 100 times longer or shorter.
[[nodiscard]] Result<Rethreaded> rethread(const Clip& clip, const HumanMapping& mapping,
                                          const GroundPath& path, const RethreadOptions& options,
                                          const std::string& file);

}  // namespace retarget
