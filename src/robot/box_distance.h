#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace retarget {

/// How far something is from a box, all in the box's frame: its centre the origin, its sides along
/// the axes.
struct CoreDistance {
  double distance = 0.0;  ///< Metres; negative: minus the least way out.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Unit, from the box to the other.
  Eigen::Vector3d on_box = Eigen::Vector3d::Zero();  ///< The other's is on_box + distance * normal.
};

/// The segment centre +- half; a point for half = 0.
[[nodiscard]] CoreDistance segment_to_box(const Eigen::Vector3d& half_size,
                                          const Eigen::Vector3d& centre,
                                          const Eigen::Vector3d& half);

/// Box b seen from box a.
[[nodiscard]] CoreDistance box_to_box(const Eigen::Vector3d& half_size_a,
                                      const Eigen::Vector3d& half_size_b,
                                      const Eigen::Vector3d& centre_of_b,
                                      const Eigen::Matrix3d& a_from_b);

}  // namespace retarget
