#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "human/source_feet.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// What of a robot rests on the floor where a knee, an elbow, a hand, the seat or the back of its human does.
struct SupportBody {
  /// The end of a shape.
  struct Point {
    int link = 0;  ///< Of Robot::tree().
    Eigen::Vector3d in_link = Eigen::Vector3d::Zero();
    double radius = 0.0;  ///< The surface is so much below it, metres.
  };
  std::size_t support = 0;                           ///< Index into kSupportBones.
  int link = 0;                                      ///< Of the body that follows the bone,
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< and what of it stays in place.
  std::vector<Point> points;                         ///< What touches: the lowest of these.
};

/// Those of a robot with collision shapes there, in the order of kSupportBones. A knee is the upper half of a shank,
/// an elbow that of a forearm, a hand what comes behind the forearm; seats are the pelvis and what is near
/// it of the links to the thighs.
[[nodiscard]] std::vector<SupportBody> support_bodies(const Robot& robot,
                                                      const ResolvedConfig& config);

}  // namespace retarget
