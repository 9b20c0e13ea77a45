#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "retarget/export.h"
#include "retarget/motion.h"

namespace RETARGET_API retarget {

/// Returns the heading of a body in radians: the angle about z from the world's x axis to the
/// horizontal projection of the body's; for a body whose x axis is nearly vertical, the twist of
/// its rotation about z.
[[nodiscard]] double heading(const Eigen::Quaterniond& world_from_body);

/// Translates and rotates a whole motion so that its first configuration has the root at x = y = 0
/// and heading 0. Heights and relative poses do not change.
class StartNormalizer {
 public:
  /// @param first  configuration in RobotClip's layout.
  explicit StartNormalizer(std::span<const double> first);
  /// From the first frame of a clip; without frames, it moves nothing.
  explicit StartNormalizer(const RobotClip& clip);

  void apply(std::span<double> qpos) const;
  void apply(RobotClip& clip) const;

 private:
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
};

/// Applies StartNormalizer to a whole clip.
void normalize_start(RobotClip& clip);

}  // namespace retarget
