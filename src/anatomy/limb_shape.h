#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "anatomy/branches.h"
#include "anatomy/limbs.h"
#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// The points and axis of a limb in the reference configuration, in the world.
struct LimbShape {
  std::vector<int> joints;
  int middle = 0;         ///< Index into joints.
  Eigen::Vector3d root;   ///< Where the joints before the middle one meet.
  Eigen::Vector3d bend;   ///< On the middle joint's axis, across from root and end.
  Eigen::Vector3d end;    ///< Where the joints beyond it meet, or where the limb ends.
  Eigen::Vector3d axis;   ///< Of the middle joint.
  double straight = 0.0;  ///< Its position with the limb straight.
  double flexion = 0.0;   ///< Sign of the positions that bend the limb; 0: the range is even.
  double clarity = 0.0;
  std::size_t at_root = 0;  ///< Joints right before the middle one that bend the limb there too.
  std::size_t at_end = 0;   ///< Likewise, of those right beyond it.
  std::optional<int> toe;   ///< A joint that was left out at the end of a leg.
  bool end_is_estimated = false;
  std::optional<int> end_body;  ///< Fixed to the last body, at the limb's end.

  /// Unit directions of the two segments, across the axis.
  [[nodiscard]] Eigen::Vector3d upper() const;
  [[nodiscard]] Eigen::Vector3d lower() const;
};

/// Splits a chain at its knee or elbow; none when no hinge of it parts it into two segments of
/// plausible lengths.
///
/// Hinges next to the middle one that bend the limb at the same place (knees and elbows of two
/// hinges) belong to it. A toe at the end of a leg is left out. An arm whose joints beyond the elbow
/// all pass it has no wrist: what is fixed to its last body marks its end, else its masses do, else
/// the axis that turns it gives its direction and a human's forearm its length.
///
/// Legs bend in one plane: their hip and ankle are taken on the hinges there whose axes are most
/// like the knee's. Forearms whose joints beyond the elbow all turn about the forearm end at the
/// farthest body that is fixed to the last of them.
/// @param reference  the configuration that `posed` is in.
/// @param at         the middle joint, where it is known: index into the chain.
[[nodiscard]] std::optional<LimbShape> shape_limb(const Robot& robot, const TreeState& posed,
                                                  const std::vector<double>& reference,
                                                  const std::vector<int>& chain, bool is_leg,
                                                  std::optional<int> at = std::nullopt);

/// Points of a moving body and of what is fixed to it, in the world of `posed`: origins of bodies,
/// corners of the boxes around geoms.
[[nodiscard]] std::vector<Eigen::Vector3d> outline_points(const Robot& robot,
                                                          const TreeState& posed, int body);

}  // namespace retarget
