#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/pose.h"
#include "retarget/robot.h"
#include "robot/shape_distance.h"

namespace retarget {

/// Two shapes that should not touch; indices into CollisionModel::shapes, a < b.
struct ShapePair {
  int a = 0;
  int b = 0;

  friend bool operator==(const ShapePair&, const ShapePair&) = default;
};

/// Where a robot can touch itself and the floor: its collision shapes and the pairs of them that
/// count as self-collision. Immutable; threads may share it. Nothing here is allocated per frame.
///
/// All pairs of shapes are tested but those of one body, of bodies that are rigidly connected, of
/// parent and child (also when rigid bodies hang between them: MuJoCo's rule), and of the robot's
/// allowed_self_contact.
class CollisionModel {
 public:
  explicit CollisionModel(const Robot& robot);

  /// Robot::collision_shapes, in its order.
  [[nodiscard]] const std::vector<CollisionShape>& shapes() const { return shapes_; }
  /// Sorted by a, then b.
  [[nodiscard]] const std::vector<ShapePair>& pairs() const { return pairs_; }

  /// @param world_from_body  poses of all bodies, as forward_kinematics gives them.
  /// @param in_world         shapes().size() shapes, filled.
  void place(std::span<const Pose> world_from_body, std::span<RoundedShape> in_world) const;

  /// The pairs, in order, whose bounding spheres are less than `margin` (metres) apart: all that
  /// can be nearer than it, and some that are not. Written over `near`, whose memory is kept.
  void near_pairs(std::span<const RoundedShape> placed, double margin,
                  std::vector<ShapePair>& near) const;

 private:
  std::vector<CollisionShape> shapes_;
  std::vector<RoundedShape> in_body_;
  std::vector<ShapePair> pairs_;
};

}  // namespace retarget
