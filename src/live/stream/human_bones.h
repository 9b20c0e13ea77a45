#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/pose.h"

namespace retarget {

/// A joint's pose relative to its parent, from world poses.
/// @param parent  index into world_from_joint; -1: no parent.
[[nodiscard]] inline Pose parent_from_joint(std::span<const Pose> world_from_joint, int parent,
                                            const Pose& world_from_this) {
  if (parent < 0) return world_from_this;
  return world_from_joint[static_cast<std::size_t>(parent)].inverse() * world_from_this;
}

/// Finds the human in a clip and converts it to a separate clip (clip_of_human), so that formats
/// with fixed bones can play any clip.
/// @param data_folder  contains configs/skeletons.
/// Errors: those of find_human and clip_of_human.
[[nodiscard]] Result<Clip> clip_of_human_bones(Clip clip, const HumanOptions& options,
                                               const std::string& data_folder);

/// World poses of the bones in a frame of such a clip.
class BonePoses {
 public:
  BonePoses() = default;
  /// @param clip  a result of clip_of_human_bones.
  explicit BonePoses(const Clip& clip);

  [[nodiscard]] bool has(Bone bone) const { return joint_of_bone_[bone] >= 0; }
  /// Computes the poses of a frame of the clip.
  void set_frame(const Clip& clip, int frame);
  /// Pose in the current frame, or in the T-pose before the first one: metres, Z up. The rotation
  /// is relative to the T-pose that faces x.
  /// @pre has(bone)
  [[nodiscard]] const Pose& world_from_bone(Bone bone) const {
    return world_from_joint_[static_cast<std::size_t>(joint_of_bone_[bone])];
  }
  /// Poses of a format's bones. Receivers expect every bone, so a missing one moves with its
  /// parent.
  /// @param rows  each has a `bone` and a `parent`: the index of an earlier row; -1: none.
  [[nodiscard]] std::vector<Pose> poses_of(const auto& rows) const {
    std::vector<Pose> world_from_row;
    for (const auto& row : rows) {
      if (has(row.bone)) {
        world_from_row.push_back(world_from_bone(row.bone));
      } else {
        world_from_row.push_back(
            row.parent < 0 ? Pose{} : world_from_row[static_cast<std::size_t>(row.parent)]);
      }
    }
    return world_from_row;
  }

 private:
  BoneArray<int> joint_of_bone_{-1};
  std::vector<Pose> world_from_joint_;
};

/// Converts a bone's pose from world-aligned axes in the T-pose to body axes: x to the body's left,
/// y up, z ahead. Bones of SMPL and Unity have such axes (in Unity, left-handed).
[[nodiscard]] Pose with_z_ahead(const Pose& world_from_bone);

/// Converts a pose from a Z-up to a Y-up world: x does not change, z becomes y.
[[nodiscard]] Pose in_y_up_world(const Pose& world_from_bone);

/// Mirrors a pose across x, for Unity's left-handed worlds. Applying it twice gives the original
/// pose.
[[nodiscard]] Pose mirrored_across_x(const Pose& pose);

/// Returns the clip with unit and up axis in its origin. If the file does not contain them, they
/// are inferred with the human in it.
/// @param data_folder  contains configs/skeletons.
/// Errors: those of find_human.
[[nodiscard]] Result<Clip> clip_with_units(Clip clip, const HumanOptions& options,
                                           const std::string& data_folder);

/// Converts poses of a clip to metres and another up axis, for protocols with a fixed unit and
/// world. Joint axes rotate with the world, so that a zero pose remains a zero pose.
class ClipAxes {
 public:
  ClipAxes() = default;
  /// @param clip  has unit and up axis in its origin (clip_with_units); otherwise they stay
  ///   unchanged.
  ClipAxes(const Clip& clip, const Eigen::Vector3d& up);

  [[nodiscard]] Pose metric(const Pose& pose) const {
    return {turn_ * pose.rotation * turn_.conjugate(),
            metres_per_unit_ * (turn_ * pose.translation)};
  }
  [[nodiscard]] Eigen::Vector3d metric(const Eigen::Vector3d& offset) const {
    return metres_per_unit_ * (turn_ * offset);
  }

 private:
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  double metres_per_unit_ = 1.0;
};

}  // namespace retarget
