#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/pose.h"

namespace retarget {

/// The canonical human in a clip, as a clip of its own: what formats of streams play that have bones
/// of their own, so that any clip can be played in them.
///
/// A joint for each bone that the clip has, under its name (bone_name), metres, Z up. The zero pose is
/// the T-pose that faces x, and all joints have the world's axes in it. Bones that are not rigidly
/// joined, such as those of a spine of which some joints are left out, have translations. The
/// origin tells the body's height.
/// @param data_folder  with configs/skeletons.
/// Errors: those of find_human.
[[nodiscard]] Result<Clip> clip_of_human_bones(Clip clip, const HumanOptions& options,
                                               const std::string& data_folder);

/// Frames of such a clip, bone by bone.
class BonePoses {
 public:
  BonePoses() = default;
  /// @param clip  of clip_of_human_bones.
  explicit BonePoses(const Clip& clip);

  [[nodiscard]] bool has(Bone bone) const { return joint_of_bone_[bone] >= 0; }
  /// Takes a frame of the clip.
  void set_frame(const Clip& clip, int frame);
  /// In the frame that was taken, or before the first one in the T-pose: metres, Z up; the rotation
  /// is that from the T-pose that faces x.
  /// @pre has(bone)
  [[nodiscard]] const Pose& world_from_bone(Bone bone) const {
    return world_from_joint_[static_cast<std::size_t>(joint_of_bone_[bone])];
  }

 private:
  BoneArray<int> joint_of_bone_{-1};
  std::vector<Pose> world_from_joint_;
};

/// A bone's pose where its axes in the T-pose are not those of a world it faces x in, but its own: x to
/// the body's left, y up, z ahead. Such are the bones of SMPL and, but for their hand, Unity.
[[nodiscard]] Pose with_z_ahead(const Pose& world_from_bone);

/// The same pose in a world with y up in place of z: x stays, z becomes y.
[[nodiscard]] Pose in_y_up_world(const Pose& world_from_bone);

/// A pose seen in a mirror across x: Unity's worlds are left-handed. Twice is none.
[[nodiscard]] Pose mirrored_across_x(const Pose& pose);

}  // namespace retarget
