#include "retarget/human/bone_map.h"

#include "human/skeleton_tree.h"

namespace retarget {

int rotation_joint(const BoneMap& map, const Skeleton& skeleton, std::string_view bone) {
  const int joint = map.joint(bone), hips = map.joint("Hips");
  if (joint < 0 || hips < 0 || joint == hips) return joint;
  // joints above the hips carry the part of the body that lies nearer to the hips
  const SkeletonTree tree(skeleton);
  const int parent = tree.parent(joint);
  return parent >= 0 && tree.between(joint, 0, hips) ? parent : joint;
}

}  // namespace retarget
