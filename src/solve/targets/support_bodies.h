#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "human/gait/source_feet.h"
#include "retarget/kinematic_tree.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "scene/scene_world.h"

namespace retarget {

/// The robot part that supports the robot while the human rests on a knee, elbow or hand, the seat
/// or the back.
struct SupportBody {
  /// The end of a collision shape.
  struct Point {
    int link = 0;                                       ///< Link of Robot::tree().
    Eigen::Vector3d in_link = Eigen::Vector3d::Zero();  ///< Position in the link frame, metres.
    double radius = 0.0;  ///< Radius of the sphere around the point, metres.
  };
  std::size_t support = 0;                           ///< Index into kSupportBones.
  int link = 0;                                      ///< Link of the body that follows the bone.
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< Point that a contact holds, in the link
                                                     ///< frame, metres.
  std::vector<Point> points;                         ///< Candidate contact points; the lowest one
                                                     ///< touches.

  /// A point in a pose of the robot.
  struct Touch {
    int link = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< Centre of the sphere, world, metres.
    double height = 0.0;                              ///< Height of its lowest point, metres.
  };
  [[nodiscard]] Touch lowest(const TreeState& pose) const;
  [[nodiscard]] static Touch touch_of(const Point& point, const TreeState& pose);

  /// The point that is nearest to a body of a scene.
  struct SceneTouch {
    int link = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();    ///< Centre of the sphere, world, metres.
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Outward normal of the surface, world.
    double distance = 0.0;  ///< Distance between the surfaces, metres; infinite without points.
  };
  [[nodiscard]] SceneTouch nearest(const TreeState& pose, const SceneWorld& world, int frame,
                                   std::size_t scene_body) const;
  /// Position of `middle`, world, metres.
  [[nodiscard]] Eigen::Vector3d world_middle(const TreeState& pose) const {
    return pose.world_from_link[static_cast<std::size_t>(link)] * middle;
  }
};

/// The support bodies with collision shapes, in the order of kSupportBones. A knee is the upper
/// half of a shank, an elbow the upper half of a forearm, a hand all links beyond the forearm. The
/// seat is the pelvis with the nearby part of the links between pelvis and knees.
[[nodiscard]] std::vector<SupportBody> support_bodies(const Robot& robot,
                                                      const ResolvedConfig& config);

}  // namespace retarget
