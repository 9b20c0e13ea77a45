#pragma once

#include <string>

#include "human/skeleton/calibrate.h"
#include "retarget/clip.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Maps a skeleton with LAFAN1's joint names; toes may have the name ToeBase.
inline BoneMap lafan1_map(const Skeleton& skeleton, const std::string& profile) {
  BoneMap map;
  map.profile = profile;
  for (const Bone bone : kMappedBones) {
    const std::string name(bone_name(bone));
    auto joint = skeleton.find(name);
    if (!joint && name.ends_with("Toe")) joint = skeleton.find(name + "Base");
    map.joint_of_bone[bone] = joint.value_or(-1);
  }
  return map;
}

/// Calibration of the published method for such a skeleton, independent of its axes and lengths.
inline Calibration lafan1_calibration(const Skeleton& skeleton) {
  const BoneMap map = lafan1_map(skeleton, "lafan1");
  return lafan1_calibration(map.joint_of_bone, map.joint_of_bone);
}

inline HumanClip lafan1_human(const Clip& clip) {
  return to_human(clip, lafan1_calibration(clip.skeleton()));
}

}  // namespace retarget
