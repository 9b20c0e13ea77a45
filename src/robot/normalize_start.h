#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "retarget/motion.h"

namespace retarget {

/// Heading of a body: the angle about z from the world's x axis to the body's, seen from above;
/// for a body whose x axis points nearly up or down, the twist of its rotation about z. Radians.
[[nodiscard]] double heading(const Eigen::Quaterniond& world_from_body);

/// Moves and turns a motion as a whole so that one configuration, its first, has the root at
/// x = y = 0 and heading 0. Heights and everything relative stay.
class StartNormalizer {
 public:
  /// @param first  configuration in the layout of RobotClip.
  explicit StartNormalizer(std::span<const double> first);

  void apply(std::span<double> qpos) const;

 private:
  Eigen::Vector3d origin_;
  Eigen::Quaterniond turn_;
};

/// StartNormalizer for a whole clip.
void normalize_start(RobotClip& clip);

}  // namespace retarget
