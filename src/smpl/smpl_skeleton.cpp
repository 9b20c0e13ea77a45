#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "retarget/clip.h"
#include "smpl/smpl_body.h"

namespace retarget {
namespace {

// a leg, the other one, the trunk up to the head, an arm, the other one
constexpr std::array<int, kSmplJointCount> kDepthFirst = {
    0, 1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12, 15, 13, 16, 18, 20, 14, 17, 19, 21};

}  // namespace

std::span<const int> smpl_skeleton_order() {
  return kDepthFirst;
}

std::shared_ptr<const Skeleton> smpl_skeleton(const SmplRestBody& body) {
  std::array<int, kSmplJointCount> place{};  // in the skeleton, of each SMPL joint
  std::vector<Joint> joints;
  for (const int index : kDepthFirst) {
    place[index] = static_cast<int>(joints.size());
    const int parent = kSmplParents[index];
    Joint joint;
    joint.name = kSmplJointNames[index];
    joint.offset = body.joints[index];
    joint.channels = {Channel::kZRotation, Channel::kYRotation, Channel::kXRotation};
    if (parent < 0) {
      joint.channels.insert(joint.channels.begin(),
                            {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition});
    } else {
      joint.parent = place[parent];
      joint.offset -= body.joints[parent];
    }
    for (std::size_t tip = 0; tip < kSmplTipJoints.size(); ++tip) {
      if (kSmplTipJoints[tip] == index)
        joint.end_sites.push_back(body.tips[tip] - body.joints[index]);
    }
    joints.push_back(std::move(joint));
  }
  return std::make_shared<const Skeleton>(std::move(joints));
}

}  // namespace retarget
