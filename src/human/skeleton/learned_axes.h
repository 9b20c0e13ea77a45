#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "human/skeleton/rest_pose.h"

namespace retarget {

/// Returns the Z axis of a limb's canonical bone along `x` from the normal of the bend (upper x
/// lower bone): the opposite direction, for arms corrected by the habits that learned_axes
/// subtracts. Both arguments are unit vectors and perpendicular.
[[nodiscard]] Eigen::Vector3d canonical_z(Bone bone, const Eigen::Vector3d& x,
                                          const Eigen::Vector3d& normal);

/// Axes of bones in their joints, learned from a movement.
struct LearnedAxes {
  JointFromBone axes;
  BoneArray<double> error;  ///< Expected angle from the true axes, degrees.

  /// Whether the movement shows the axes; others are those of the pose that learning began with.
  [[nodiscard]] bool is_learned(Bone bone) const;
};

/// Learns the axes of the canonical bones in their joints from a movement, for skeletons without a
/// usable rest pose (docs/human.md, "Learned axes" and "Rest poses compared").
///
/// Bones with too little movement (arms that never bend) keep the axes of `best`. A forearm without
/// a length continues the upper arm as in the zero pose.
/// @param poses  not empty
/// @param up     up axis of the file, unit length
/// @param best   the pose closest to a T-pose
[[nodiscard]] LearnedAxes learned_axes(const Body& body, const std::vector<JointPoses>& poses,
                                       const Eigen::Vector3d& up, const RestCandidate& best);

/// Returns the axes of a rest pose, with learned axes for upper arm, forearm and hand if the
/// movement bends the elbow about an axis more than 20 degrees off: the roll of a rest pose's arms
/// is arbitrary.
/// @param poses  may be empty
[[nodiscard]] JointFromBone with_corrected_arms(const Body& body,
                                                const std::vector<JointPoses>& poses,
                                                const Eigen::Vector3d& up, JointFromBone axes);

/// Returns the axes of a rest pose, with learned axes for thighs and shins if the knee clearly
/// bends about another axis than that of the rest pose, in thigh and shin alike: rotations then
/// belong to another skeleton.
[[nodiscard]] JointFromBone with_corrected_legs(const Body& body,
                                                const std::vector<JointPoses>& poses,
                                                const Eigen::Vector3d& up, JointFromBone axes);

/// Compares the feet of axes with the movement, in which feet stand flat.
class SoleCheck {
 public:
  /// @param poses  may be empty
  SoleCheck(const Body& body, const std::vector<JointPoses>& poses, const Eigen::Vector3d& up);

  /// Mean angle between the soles of the axes and those that the movement shows, degrees; empty if
  /// no foot stands flat in at least five poses.
  [[nodiscard]] std::optional<double> error(const JointFromBone& axes) const;

  /// Returns the axes with learned feet if the feet of the rest pose do not stand: the sole is more
  /// than 20 degrees off that of the movement, and its foot more than 15 degrees steeper or flatter
  /// than the canonical one. The second condition excludes dancers who stand on their toes.
  [[nodiscard]] JointFromBone corrected(const RestCandidate& rest, JointFromBone axes) const;

 private:
  [[nodiscard]] std::optional<double> error_of(const JointFromBone& axes, std::size_t side) const;

  const Body& body_;
  const std::vector<JointPoses>& poses_;
  const Eigen::Vector3d up_;
  std::array<std::optional<Eigen::Matrix3d>, 2> level_;  // Toe axes of a flat foot, by side.
};

}  // namespace retarget
