#pragma once

#include <Eigen/Core>
#include <optional>

#include "retarget/clip.h"
#include "retarget/human_poser.h"

namespace retarget {

/// Evidence that a world is not level, from the part of a motion in which feet stand.
struct FloorTilt {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< Normal of the floor; unit length.
  double angle = 0.0;                             ///< Angle between the normal and z, rad.
  bool by_balance = false;                        ///< Known only as well as find_balance knows it.
};

/// Finds a floor that is tilted by more than 8 degrees, such as that of video estimates in the axes
/// of their camera. Two independent observations must agree: the plane of the standing toes (least
/// squares of the distances) and the mean line from hips to neck, both tilted by more than 8 degrees
/// and less than 0.6 of the tilt apart. A body on a slope stands upright, and one that stoops leans
/// away from the normal of a level floor. The toes must spread over an area and fit a plane. On one
/// spot, the balance of a body that stands still is sufficient (find_balance), if it is tilted by 12
/// to 45 degrees.
/// @param poser  poses, metres, Z up
/// @return empty if the floor is level or there is not enough evidence
[[nodiscard]] std::optional<FloorTilt> find_floor_tilt(HumanPoser& poser, FrameRange part);

}  // namespace retarget
