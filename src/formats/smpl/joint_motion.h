#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/array_source.h"
#include "formats/smpl/motion_arrays.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// Joint positions over time, in the units and axes of the file.
struct JointMotion {
  int frame_count = 0;
  int joint_count = 0;
  std::vector<Eigen::Vector3d> positions;  ///< Positions in the world frame, frame-major.
  /// world_from_joint, frame-major; identity in a T-pose. Empty if the file has no rotations.
  std::vector<Eigen::Quaterniond> rotations;
  std::vector<std::string> names;  ///< Joint names; empty if the file has none.
  FrameRate rate;
  /// The file gives no rate, and `rate` is an arbitrary one. Reported after faults of the joints,
  /// which a rate does not repair.
  std::optional<Error> no_rate;
  /// The rate is only the usual one of files with this joint order; empty: it is another one.
  std::string_view order_of_rate;
  std::optional<double> height;       ///< Body height in metres, if the file has it.
  std::optional<Eigen::Vector3d> up;  ///< Up direction, if the format defines it.
  std::vector<Warning> warnings;

  [[nodiscard]] const Eigen::Vector3d& position(int frame, int joint) const {
    return positions[index(frame, joint)];
  }
  [[nodiscard]] std::size_t index(int frame, int joint) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(joint_count) +
           static_cast<std::size_t>(joint);
  }
};

/// Whether the file has an array of joint positions under a known name.
[[nodiscard]] bool has_joint_positions(const ArraySource& file);

/// Reads joint positions of shape (frames, joints, 3), (samples, frames, joints, 3) or MDM's
/// (samples, joints, 3, frames). Kimodo's files also have rotations.
///
/// The rate is read from `fps` or a similar array. Without one, the usual rate of the data set is
/// assumed with a warning: 20 fps for 22 joints without names in the file, which are then those of
/// HumanML3D and MDM and have Y up by definition, 120 fps for holosoma's 53 joints, 30 fps for
/// `global_joint_positions` and for Kimodo.
/// Errors: other shapes, no frames, numbers that are not finite, several motions without a choice, a
/// wrong number of names. Without a known rate, JointMotion::no_rate is set.
[[nodiscard]] Result<JointMotion> read_joint_motion(const ArraySource& file,
                                                    const ArrayReadOptions& options);

/// A joint order in which some program writes joint positions.
struct JointOrder {
  std::string_view name;    ///< Name for messages: `SMPL-X`.
  std::string_view joints;  ///< Names separated by spaces; `*` stands for the fingers of a hand,
                            ///< `+` for SOMA's fingers.
  std::size_t unread = 0;   ///< Number of further joints, which are not read.

  /// Names of the joints that are read, spelled so that skeleton recognition knows them.
  [[nodiscard]] std::vector<std::string> names() const;
  /// Number of all joints in the file.
  [[nodiscard]] std::size_t joint_count() const { return names().size() + unread; }
};

/// Known orders of joint positions without names. Several orders have the same number of joints;
/// the positions decide between them.
[[nodiscard]] std::span<const JointOrder> joint_orders();

/// Orders of Kimodo's files, which also have joint rotations. Their joint counts are distinct.
[[nodiscard]] std::span<const JointOrder> kimodo_orders();

/// Whether the coordinates of a point are finite and not all equal. Programs write 0 or another
/// number three times for a lost point.
[[nodiscard]] bool is_tracked(const Eigen::Vector3d& point);

/// Longest gap that bridge_lost_points() fills, frames.
inline constexpr int kLongestBridge = 30;

/// A joint and the frames in which it is lost.
struct LostPoint {
  int joint = 0;
  FrameRange frames;
};

/// Bridges frames in which a joint is lost by a straight line between those in which it is known. A
/// joint is lost if its coordinates are NaN, or if it is exactly at the origin, far from its
/// positions before and after. Bridges at most kLongestBridge frames. At the start or end, NaN
/// stays, and a joint that jumps to the origin without the body keeps its nearest position. Adds
/// warnings with the joints and the number of frames.
/// @return the first joint that is lost inside the motion for longer
std::optional<LostPoint> bridge_lost_points(JointMotion& motion);

}  // namespace retarget
