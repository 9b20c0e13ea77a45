#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// Shares of a limb's lengths by which its joints are told apart.
inline constexpr double kLeastSegment = 0.2;  ///< Of the other segment: shorter is no segment.

/// How many joints nearest to the knee or elbow, of those on one side of it, bend the limb there as
/// well: their axes pass it and miss the hip, shoulder, ankle or wrist, where the rest meets. At
/// least one joint is left to the rest, so that a twist or a ball joint never counts.
/// @param joints  of the limb on one side of the middle joint, the one nearest to it first.
[[nodiscard]] std::size_t joints_at_middle(const TreeState& posed, std::span<const int> joints,
                                           const Eigen::Vector3d& middle);

/// Whether the axis of every joint passes a point within a distance: joints that turn a forearm, or
/// bend its elbow once more, and mark no wrist.
[[nodiscard]] bool all_pass(const TreeState& posed, std::span<const int> joints,
                            const Eigen::Vector3d& point, double within);

/// Where a limb ends that has no wrist.
struct SegmentEnd {
  Eigen::Vector3d point;
  std::optional<int> body;  ///< Fixed there.
  bool estimated = false;   ///< Nothing marks it.
};

/// The knee or elbow that a segment begins at, and what lies before and beyond it.
struct SegmentStart {
  int body = 0;  ///< The last that a joint of the limb moves.
  Eigen::Vector3d root, middle;
  Eigen::Vector3d axis;         ///< Of the knee or elbow; the segment lies across it.
  std::span<const int> beyond;  ///< Joints that pass the middle.
};

/// The farthest body that is fixed to the limb's last one, else what its masses tell, which lie
/// about the middle of a segment, else a human's length along the axis of a joint that turns the
/// segment; `middle` where nothing tells.
[[nodiscard]] SegmentEnd segment_end(const Robot& robot, const TreeState& posed,
                                     const SegmentStart& start);

/// Cosine: an axis that lies along a segment turns it.
inline constexpr double kTurnsAlong = 0.9;

}  // namespace retarget
