#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "human/skeleton/calibrate.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/options.h"
#include "retarget/pose.h"

namespace retarget {

/// World poses of all joints, in file units and axes.
using JointPoses = std::vector<Pose>;

/// Returns the pose with all rotations zero.
[[nodiscard]] JointPoses zero_pose(const Skeleton& skeleton);

/// As above for the skeleton of a clip. Position channels that are constant in all frames replace
/// OFFSETs that contradict them: some files have only zero OFFSETs.
[[nodiscard]] JointPoses zero_pose(const Clip& clip);

[[nodiscard]] JointPoses frame_pose(const Clip& clip, int frame);

/// Returns the frames to sample a motion at: ten per second from `begin` on, so that copies at
/// other rates are sampled at the same times; every frame if the clip has a lower rate; about 1000
/// frames at most.
/// @param begin  first frame to use.
[[nodiscard]] std::vector<int> sampled_frames(const Clip& clip, int begin = 0);

/// Returns the joints below the root whose position channels keep them at their parents in all
/// frames, up to noise of 0.3 % of a usual bone's length (BoneMap::in_place).
[[nodiscard]] std::vector<int> joints_in_place(const Clip& clip);

/// Of the joints that coincide with `joint`, returns the uppermost that no other bone uses.
[[nodiscard]] int first_in_place(const Skeleton& skeleton, const BoneMap& map, int joint);

/// Start and end of a bone.
struct Segment {
  int joint = -1;                                    ///< The bone's joint; -1: unknown.
  int end_joint = -1;                                ///< The joint of the far end.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Offset of the far end, in end_joint's
                                                     ///< frame.

  [[nodiscard]] bool known() const { return joint >= 0 && end_joint >= 0; }
};

/// The mapped joints of a skeleton and the segments of its bones.
class Body {
 public:
  Body(const Skeleton& skeleton, const BoneMap& map);

  [[nodiscard]] const Skeleton& skeleton() const { return *skeleton_; }
  [[nodiscard]] int joint(Bone bone) const { return joints_[bone]; }
  [[nodiscard]] const BoneArray<int>& joints() const { return joints_; }
  /// The mapped joints of a bone of both sides.
  [[nodiscard]] std::vector<int> joints_of(LimbBone part) const;
  [[nodiscard]] bool has(Bone bone) const { return joint(bone) >= 0; }
  /// Joint whose rotation turns the bone (see rotation_joint); joint() is where the bone begins.
  /// -1: the bone has no joint, or its rotation is not reliable.
  [[nodiscard]] int turning_joint(Bone bone) const { return turning_joints_[bone]; }
  [[nodiscard]] const BoneArray<int>& turning_joints() const { return turning_joints_; }
  /// Marks the bone's rotation as unknown; its position stays known.
  void disbelieve_rotation(Bone bone) { turning_joints_[bone] = -1; }
  /// Makes a joint inside the bone turn it.
  void turn_by(Bone bone, int joint) { turning_joints_[bone] = joint; }
  /// Segment to the next mapped bone, or from a last bone to its farthest child or end site.
  [[nodiscard]] const Segment& segment(Bone bone) const { return segments_[bone]; }

 private:
  [[nodiscard]] Segment find_segment(Bone bone) const;

  const Skeleton* skeleton_;
  BoneArray<int> joints_, turning_joints_;
  BoneArray<Segment> segments_;
};

/// Vector from the bone's joint to its far end, world axes; nothing if unknown or of zero length.
[[nodiscard]] std::optional<Eigen::Vector3d> along(const Segment& segment, const JointPoses& pose);

/// Returns a bone's length by the OFFSETs along it, in file units; 0 if unknown.
[[nodiscard]] double length_by_offsets(const Body& body, Bone bone);

/// Returns the minimal rotation that takes unit vector a to unit vector b. For opposite vectors (to
/// 1e-6 rad) it is half a turn about `fallback`, which must be perpendicular to them, followed by
/// the remaining rotation.
[[nodiscard]] Eigen::Matrix3d minimal_rotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                               const Eigen::Vector3d& fallback);

/// Body axes in a pose: the rows are forward, left and up in file axes, so the matrix maps file
/// directions to x forward, y left, z up.
using BodyFromFile = Eigen::Matrix3d;

/// Left is the direction from the right to the left hip and upper arm, orthogonal to `up`; forward
/// is left x up. Returns nothing if this direction is degenerate.
[[nodiscard]] std::optional<BodyFromFile> body_axes(const Body& body, const JointPoses& pose,
                                                    const Eigen::Vector3d& up);

/// Like body_axes, with a given facing. `forward` must not be parallel to `up`.
[[nodiscard]] BodyFromFile given_axes(const Eigen::Vector3d& forward, const Eigen::Vector3d& up);

/// Returns the axis closest to a direction.
[[nodiscard]] SignedAxis nearest_axis(const Eigen::Vector3d& direction);

/// Direction from the hips to the head, or to the highest mapped trunk bone; unit length.
[[nodiscard]] std::optional<Eigen::Vector3d> trunk_direction(const Body& body,
                                                             const JointPoses& pose);

/// Rotation from file axes to z up: the identity for +z, a quarter turn about x for +y. The
/// determinant is +1 for every axis.
[[nodiscard]] Eigen::Matrix3d z_up_from_file(const SignedAxis& up);

/// Returns the rotation to z up for a unit vector: the rotation of its nearest axis, then the
/// smallest rotation that maps the vector to z.
[[nodiscard]] Eigen::Matrix3d z_up_from_file(const Eigen::Vector3d& up);

/// Angle between the up direction of a calibration and the nearest axis of the file, degrees; 0 for
/// an axis.
[[nodiscard]] double tilt_degrees(const Calibration& calibration);

/// Joint positions of a skeleton in several poses; file units and axes.
struct BodyPoses {
  struct Pose {
    std::vector<Eigen::Vector3d> joints;  ///< World positions.
    std::vector<Eigen::Vector3d> tips;    ///< Farthest end site of each joint, or the joint itself.
  };
  std::vector<Pose> poses;  ///< Poses; at least one.
  /// Mean distance of each joint from its parent; 0 for the root and for joints that only position
  /// the body.
  std::vector<double> lengths;
  bool from_motion = false;  ///< False: the only pose has all rotations zero.
};

/// The pose with all rotations zero, which need not look human.
[[nodiscard]] BodyPoses sample_zero_pose(const Skeleton& skeleton);

/// Samples at most 48 frames, spread evenly over the clip; the zero pose if the clip has no frames.
[[nodiscard]] BodyPoses sample_poses(const Clip& clip);

}  // namespace retarget
