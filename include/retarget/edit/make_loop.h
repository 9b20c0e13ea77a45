#pragma once

#include <string>

#include "retarget/base/result.h"
#include "retarget/edit/ground_pose.h"
#include "retarget/human/human_clip.h"
#include "retarget/motion/clip.h"

namespace retarget {

struct LoopOptions {
  double shortest = 0.0;      ///< Of the cycle, seconds; 0: half the clip.
  double window = 1.0 / 3.0;  ///< Of the frames that are compared, seconds.
  double settle = 0.25;       ///< Before the end, in which velocities come to the beginning's, s.
  bool in_place = false;      ///< The cycle neither advances nor turns.
  int times = 1;              ///< How often the cycle is played.
};

/// A cycle without a seam.
struct Loop {
  Clip clip;              ///< `cycle` frames for each time: the next one would be the first again.
  int cycle = 0;          ///< Frames of one cycle, from the source's first frame on.
  double distance = 0.0;  ///< Between beginning and end before they were joined, as WindowDistance.
  GroundPose advance;     ///< Of one cycle over the ground, before `in_place`.
};

/// Makes a cycle that begins with the clip's first frame and ends where the body is most like it,
/// after `shortest` or later. What is left between end and beginning is spread over the whole
/// cycle, evenly; the difference of velocities is taken out within `settle` before the end, so that
/// positions and velocities of all joints go on steadily from each cycle to the next.
///
/// @param file  for messages.
/// @return kInput errors: fewer than 4 frames, or than `shortest` needs; as BodyMover::of.
///     kUsage errors: `times` below 1 or that make more than 10 million frames.
[[nodiscard]] Result<Loop> make_loop(const Clip& clip, const HumanMapping& mapping,
                                     const LoopOptions& options, const std::string& file);

}  // namespace retarget
