#pragma once

#include <optional>

#include "human/body_poses.h"
#include "human/bone_map.h"
#include "human/joint_names.h"
#include "human/skeleton_tree.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// All that the ways of recognising look at.
struct BodySource {
  const Skeleton& skeleton;
  const std::string& file;
  SkeletonTree tree;
  std::vector<JointName> names;  ///< Of all joints, normalised together.
  BodyPoses poses;
};

/// A map that is still to be verified, nothing, or the error that joints of equal merit are.
using Candidate = Result<std::optional<BoneMap>>;

/// `"name"` of a joint, for messages.
[[nodiscard]] inline std::string quoted_name(const Skeleton& skeleton, int joint) {
  return "\"" + skeleton.joint(joint).name + "\"";
}

}  // namespace retarget
