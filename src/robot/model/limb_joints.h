#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"

namespace retarget {

/// Thresholds, as fractions of a limb's segment lengths, that classify its joints.
inline constexpr double kLeastSegment = 0.2;  ///< Minimum length of a segment relative to the other
                                              ///< one.
/// Minimum distance from the elbow, as a fraction of the upper arm, at which a joint that twists
/// the forearm marks the wrist if nothing bends beyond the elbow. Closer to the elbow, the anchor
/// may be anywhere on its axis.
inline constexpr double kNearestWrist = 0.28;

/// Returns the component of a vector perpendicular to a unit axis.
[[nodiscard]] Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis);

/// Counts the joints next to the knee or elbow, on one side of it, that bend the limb at the same
/// place: their axes pass the middle joint and miss the other end (hip, shoulder, ankle or wrist).
/// At least one joint is left for the other end, so that a ball joint is never included; a twist
/// joint is included only between hinges that bend the limb at the same point.
/// @param joints  joints on one side of the middle joint, nearest first.
[[nodiscard]] std::size_t joints_at_middle(const TreeState& posed, std::span<const int> joints,
                                           const Eigen::Vector3d& middle);

/// Returns true if every joint's axis passes within a distance of a point: such joints twist a
/// forearm or bend its elbow again, and do not mark a wrist.
[[nodiscard]] bool all_pass(const TreeState& posed, std::span<const int> joints,
                            const Eigen::Vector3d& point, double within);

/// End of a limb that has no wrist.
struct SegmentEnd {
  Eigen::Vector3d point;
  std::optional<int> body;  ///< Body fixed at the end, if any.
  bool estimated = false;   ///< True if no body or joint marks the end.
};

/// The knee or elbow at which a segment begins, and its neighbours.
struct SegmentStart {
  int body = 0;  ///< Last body that a joint of the limb moves.
  Eigen::Vector3d root, middle;
  Eigen::Vector3d axis;         ///< Axis of the knee or elbow; perpendicular to the segment.
  std::span<const int> beyond;  ///< Joints beyond the middle whose axes pass it.
};

/// Estimates where a segment ends: at the farthest body fixed to the limb's last body, otherwise
/// from its masses, which lie around the middle of a segment, otherwise at human proportions along
/// the axis of a joint that twists the segment. Returns `middle` if none applies.
[[nodiscard]] SegmentEnd segment_end(const Robot& robot, const TreeState& posed,
                                     const SegmentStart& start);

/// Cosine threshold: a joint axis this parallel to a segment twists it.
inline constexpr double kTurnsAlong = 0.9;

}  // namespace retarget
