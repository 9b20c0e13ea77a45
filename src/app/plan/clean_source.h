#pragma once

#include <string>
#include <vector>

#include "human/gait/clean_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/plan.h"

namespace retarget {

/// Sentences that describe the changes of clean_source_frames(); empty: none.
struct SourceNotes {
  std::string held;                      ///< Interpolated frames that repeated a pose.
  PositionJitter positions = {};         ///< Smoothed joint positions.
  SideSwaps swaps = {};                  ///< Exchanges of left and right in joint positions.
  std::vector<std::string> spikes = {};  ///< Interpolated spikes of joint positions.
};

/// Interpolates repeated frames and spikes of joint positions, undoes exchanges of left and right,
/// and smooths noisy joint positions of a clip according to HumanOptions::clean, before its human
/// is recognised.
[[nodiscard]] SourceNotes clean_source_frames(Clip& clip, const Options& options);

/// Removes frames at the end of a clip in which the tracking was lost (count_lost_end_frames) from the
/// part that a plan uses, and notes them, according to HumanOptions::clean. They stay if the options
/// name the end.
/// @pre the plan's part is known
void leave_out_lost_end(const Clip& clip, const Options& options, Plan& plan);

/// Removes noise from the part of a clip that a plan uses, according to HumanOptions::clean, and
/// records the changes. Raises the fit's contact thresholds (speeds and heights) above the residual
/// speed of standing feet, up to a limit, and lowers its weights of other contacts.
/// @param notes  result of clean_source_frames().
/// @pre the plan's options, human, part, scene and fit are known
/// Errors: those of stands_on_moving_body().
[[nodiscard]] Result<void> clean_source(Clip& clip, const SourceNotes& notes, Plan& plan);

/// Warns if the hips or thighs of a plan's clip jump (find_source_jumps). Omitted for clips of
/// robots.
/// @pre the plan's human and part are known
void doubt_jumps(const Clip& clip, Plan& plan);

/// Warns if the floor of a plan's clip is tilted (find_floor_tilt). The warning contains the value of
/// HumanOptions::up that levels the clip. Omitted for clips of robots and with scenes.
/// @pre the plan's options, human and part are known
void doubt_level(const Clip& clip, Plan& plan);

/// Scales the travel of a plan's clip (scale_travel) according to SolveOptions::travel or the preset,
/// and records the factors. Does not change the clip for a robot that does not travel.
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
