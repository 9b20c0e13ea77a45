#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "human/source_feet.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

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

  /// Where one of its points is in a pose of the robot.
  struct Touch {
    int link = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< The shape's end, in the world.
    double height = 0.0;                              ///< Of the surface below it, metres.
  };
  [[nodiscard]] Touch lowest(const TreeState& pose) const;
  /// What stays in place, in the world.
  [[nodiscard]] Eigen::Vector3d world_middle(const TreeState& pose) const {
    return pose.world_from_link[static_cast<std::size_t>(link)] * middle;
  }
};

/// Those of a robot with collision shapes there, in the order of kSupportBones. A knee is the upper half of a shank,
/// an elbow that of a forearm, a hand what comes behind the forearm; seats are the pelvis and what is near
/// it of the links to the thighs.
[[nodiscard]] std::vector<SupportBody> support_bodies(const Robot& robot,
                                                      const ResolvedConfig& config);

}  // namespace retarget
