#pragma once

#include <Eigen/Core>
#include <optional>

#include "retarget/clip.h"
#include "retarget/human_poser.h"

namespace retarget {

/// Largest error of find_balance in level windows of recorded motions, degrees.
inline constexpr double kBalanceError = 8.0;

/// Finds the vertical direction by the balance of a body that stands still on both feet with nearly
/// straight legs: its centre of mass is above its feet.
/// @return empty if the body stands still for less than 1.2 seconds in total, its centre of mass
///   moves by more than 8 degrees, or its feet have another slope than standing feet: it leans
[[nodiscard]] std::optional<Eigen::Vector3d> find_balance(HumanPoser& poser, FrameRange part);

}  // namespace retarget
