#pragma once

#include <string>

#include "edit/concatenate.h"
#include "edit/ground_pose.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

struct LoopOptions {
  double shortest = 0.0;    ///< Of the cycle, seconds; 0: half the clip.
  ConcatenateOptions seam;  ///< How end and beginning are joined, and when that is good.
  bool in_place = false;    ///< The cycle neither advances nor turns.
  int times = 1;            ///< How often the cycle is played.
};

/// A cycle without a seam.
struct Loop {
  Clip clip;      ///< `cycle` frames for each time: the next one would be the first again.
  int cycle = 0;  ///< Frames of one cycle: the source's from its first one on, but for those
                  ///< around the seam.
  double distance = 0.0;  ///< Between beginning and end before they were joined, as WindowDistance.
  GroundPose advance;     ///< Of one cycle over the ground, before `in_place`: of the world, as it
                          ///< turns about its origin,
  Eigen::Vector2d way;    ///< and of the hips, metres: how far the body comes in a cycle.
  SeamCheck check;        ///< Of where the end meets the beginning.
};

/// Makes a cycle of the clip from its first frame to where the body is most like that,
/// after `shortest` or later. The clip is joined there to itself as by `concatenate`: frames around
/// the seam are blended, feet that stand stay where they stand, the seam is checked. Positions and
/// velocities of all joints go on steadily from each cycle to the next. Where a foot stands all
/// through the cycle, the advance is that which leaves it in its place.
///
/// @param file  for messages.
/// @return the cycle; of a seam that is not good (check.faults) it is for the caller to decide.
///     kInput errors: fewer than 4 frames, or than `shortest` needs; as BodyMover::of.
///     kUsage errors: `times` below 1 or that make more than 10 million frames.
[[nodiscard]] Result<Loop> make_loop(const Clip& clip, const HumanMapping& mapping,
                                     const LoopOptions& options, const std::string& file);

}  // namespace retarget
