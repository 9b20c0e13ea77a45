#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "human/bone_map.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// World poses of all joints, file units and axes.
using JointPoses = std::vector<Pose>;

/// All rotations zero.
[[nodiscard]] JointPoses zero_pose(const Skeleton& skeleton);

/// One frame of a clip.
[[nodiscard]] JointPoses frame_pose(const Clip& clip, int frame);

/// Frames at which a movement is looked at: ten times a second from the first on, so that copies
/// at other rates are seen at the same times; every frame when the clip is slower than that; at
/// most about 1000.
/// @param begin  the first frame that counts.
[[nodiscard]] std::vector<int> sampled_frames(const Clip& clip, int begin = 0);

/// Of joints in one place the uppermost that stands for no other bone than the given one's.
[[nodiscard]] int first_in_place(const Skeleton& skeleton, const BoneMap& map, int joint);

/// From where to where a bone runs.
struct Segment {
  int joint = -1;                                    ///< The bone's joint; -1: unknown.
  int end_joint = -1;                                ///< The joint of the far end.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Of the far end, in end_joint's frame.

  [[nodiscard]] bool known() const { return joint >= 0 && end_joint >= 0; }
};

/// The mapped joints of a skeleton and where their bones run.
class Body {
 public:
  Body(const Skeleton& skeleton, const BoneMap& map);

  [[nodiscard]] const Skeleton& skeleton() const { return *skeleton_; }
  [[nodiscard]] int joint(Bone bone) const { return joints_[bone]; }
  [[nodiscard]] const BoneArray<int>& joints() const { return joints_; }
  [[nodiscard]] bool has(Bone bone) const { return joint(bone) >= 0; }
  /// The joint whose rotation turns the bone (rotation_joint); joint() is where the bone begins.
  /// -1: the bone has no joint, or none whose rotation is believed.
  [[nodiscard]] int turning_joint(Bone bone) const { return turning_joints_[bone]; }
  [[nodiscard]] const BoneArray<int>& turning_joints() const { return turning_joints_; }
  /// From now on nothing is known of how the bone turns; where it begins still is.
  void disbelieve_rotation(Bone bone) { turning_joints_[bone] = -1; }
  /// To the next mapped bone; of the last ones to the farthest child or end site.
  [[nodiscard]] const Segment& segment(Bone bone) const { return segments_[bone]; }

 private:
  [[nodiscard]] Segment find_segment(Bone bone) const;

  const Skeleton* skeleton_;
  BoneArray<int> joints_, turning_joints_;
  BoneArray<Segment> segments_;
};

/// From the bone's joint to its far end, world axes; nothing when unknown or of no length.
[[nodiscard]] std::optional<Eigen::Vector3d> along(const Segment& segment, const JointPoses& pose);

/// Length of a bone by the OFFSETs on its way, file units; 0 when it is not known.
[[nodiscard]] double length_by_offsets(const Body& body, Bone bone);

/// The minimal rotation that takes unit vector a to unit vector b; of opposite vectors half
/// a turn about `fallback`, which must be across them.
[[nodiscard]] Eigen::Matrix3d minimal_rotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                               const Eigen::Vector3d& fallback);

}  // namespace retarget
