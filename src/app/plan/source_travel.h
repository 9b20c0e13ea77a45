#pragma once

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"

namespace retarget {

/// Scales the travel of a plan's clip (scale_travel) as SolveOptions::travel or the preset says, and
/// records the factors. A robot that does not travel leaves the clip as it is.
///
/// The rule of `auto` is measured with policies for the G1: 1 up to 0.7 m/s, 0.85 from 1.5 m/s. These
/// are speeds of the robot. Legs of length L walk alike at the same Froude number v / sqrt(g L), so
/// the human's speeds are
///
///     0.7 m/s sqrt(L / 0.632 m) / k    and    1.5 m/s sqrt(L / 0.632 m) / k
///
/// where k is the scale from the human's path to the robot's.
///
/// Errors: the targets cannot be made (kInput, kConfig).
/// @pre the plan's options, robot, human, part, configuration, scale and fit are known
[[nodiscard]] Result<void> scale_source_travel(Clip& clip, Plan& plan);

}  // namespace retarget
