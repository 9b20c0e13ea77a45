#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/pose.h"
#include "retarget/robot.h"
#include "retarget/shape_distance.h"

namespace retarget {

/// Two shapes that should not touch; indices into CollisionModel::shapes, a < b.
struct ShapePair {
  int a = 0;
  int b = 0;

  friend bool operator==(const ShapePair&, const ShapePair&) = default;
};

/// The collision shapes of a robot and the pairs of them that count as self-collision. Immutable
/// and safe to share between threads. Nothing is allocated per frame.
///
/// All pairs of shapes are tested except those on one body, on rigidly connected bodies, on parent
/// and child (also across rigidly attached bodies, as in MuJoCo), and the robot's
/// allowed_self_contact pairs.
class CollisionModel {
 public:
  explicit CollisionModel(const Robot& robot);

  /// Robot::collision_shapes, in the same order.
  [[nodiscard]] const std::vector<CollisionShape>& shapes() const { return shapes_; }
  /// Sorted by a, then b.
  [[nodiscard]] const std::vector<ShapePair>& pairs() const { return pairs_; }

  /// Computes the world poses of all shapes.
  /// @param world_from_body  poses of all bodies, as computed by forward_kinematics.
  /// @param in_world         receives shapes().size() shapes.
  void place(std::span<const Pose> world_from_body, std::span<RoundedShape> in_world) const;

  /// Finds the pairs, in order, whose bounding spheres are less than `margin` (metres) apart: a
  /// superset of the pairs closer than `margin`. Overwrites `near` and reuses its memory.
  void near_pairs(std::span<const RoundedShape> placed, double margin,
                  std::vector<ShapePair>& near) const;

 private:
  std::vector<CollisionShape> shapes_;
  std::vector<RoundedShape> in_body_;
  std::vector<ShapePair> pairs_;
};

}  // namespace retarget
