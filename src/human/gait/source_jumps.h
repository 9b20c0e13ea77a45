#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human_poser.h"

namespace retarget {

/// Steps between frames in which a body moves faster than any body can.
struct SourceJumps {
  int frames = 0;           ///< Number of such steps.
  int first = 0;            ///< Frame after the first one.
  double hips_speed = 0.0;  ///< Largest impossible speed of the hips, m/s; 0: none.
  double hips_turn = 0.0;   ///< Largest impossible turning speed of the hips, rad/s; 0: none.
  double thigh_turn = 0.0;  ///< Largest impossible turning speed of a thigh relative to the hips,
                            ///< rad/s; 0: none.

  /// One phrase per kind of jump: `the hips move at 12.7 m/s`.
  [[nodiscard]] std::vector<std::string> texts() const;
};

/// Finds steps in which the hips move faster than 10 m/s or turn faster than 20 rad/s, as for the
/// metric `root_jumps`, or in which a thigh turns faster than 40 rad/s relative to the hips. Such a
/// step is more than three times as fast as those around it: spins, and video estimates of them,
/// are fast for several frames. From 180 frames per second, steps are about 1/120 s, because
/// noise would exceed these speeds.
/// @param thighs  whether the rotations of the thighs are known; otherwise those of the hips were
///   computed from positions, too, and a turn is that of hips and chest
[[nodiscard]] SourceJumps find_source_jumps(HumanPoser& poser, FrameRange part, bool thighs);

}  // namespace retarget
