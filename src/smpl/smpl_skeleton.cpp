#include <Eigen/Core>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "math/so3.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "smpl/generic_hand.h"
#include "smpl/smpl_body.h"

namespace retarget {
namespace {

// a leg, the other one, the trunk up to the head, an arm, the other one
constexpr std::array<int, kSmplJointCount> kDepthFirst = {
    0, 1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12, 15, 13, 16, 18, 20, 14, 17, 19, 21};

constexpr int kLeftWristJoint = 20;
constexpr int kJointsPerFinger = 3;
constexpr int kJointsPerHand = kSmplHandJointCount / 2;

struct SmplFinger {
  Finger finger;
  std::string_view name;
};
// in the models' order
constexpr std::array<SmplFinger, kFingerCount> kFingersInOrder = {{{Finger::kIndex, "index"},
                                                                   {Finger::kMiddle, "middle"},
                                                                   {Finger::kLittle, "pinky"},
                                                                   {Finger::kRing, "ring"},
                                                                   {Finger::kThumb, "thumb"}}};

// a joint of the hands by its number among them
struct HandPlace {
  bool is_left;
  SmplFinger finger;
  int bone;
};
HandPlace hand_place(int joint) {
  const int in_hand = joint % kJointsPerHand;
  return {joint < kJointsPerHand,
          kFingersInOrder[static_cast<std::size_t>(in_hand / kJointsPerFinger)],
          in_hand % kJointsPerFinger};
}

int parent_of(int joint) {
  if (joint < kSmplJointCount) return kSmplParents[joint];
  const HandPlace place = hand_place(joint - kSmplJointCount);
  return place.bone > 0 ? joint - 1 : kLeftWristJoint + (place.is_left ? 0 : 1);
}

std::string name_of(int joint) {
  if (joint < kSmplJointCount) return std::string(kSmplJointNames[joint]);
  const HandPlace place = hand_place(joint - kSmplJointCount);
  return (place.is_left ? "left_" : "right_") + std::string(place.finger.name) +
         std::to_string(place.bone + 1);
}

// from its parent, in the models' axes: palms are down, thumbs ahead
Eigen::Vector3d generic_offset(int joint, double height) {
  constexpr double kUsualHeight = 1.75;
  const HandPlace place = hand_place(joint - kSmplJointCount);
  const GenericFinger& finger = generic_hand()[static_cast<std::size_t>(place.finger.finger)];
  const Eigen::Vector3d in_palm =
      place.bone == 0 ? finger.knuckle
                      : Eigen::Vector3d(finger.bones[static_cast<std::size_t>(place.bone) - 1] *
                                        finger.direction);
  return height / kUsualHeight *
         Eigen::Vector3d(place.is_left ? in_palm.x() : -in_palm.x(), -in_palm.z(), in_palm.y());
}

Eigen::Vector3d offset_of(const SmplRestBody& body, int joint) {
  const auto place = [&](int index) {
    return index < kSmplJointCount ? body.joints[index]
                                   : body.hands[static_cast<std::size_t>(index - kSmplJointCount)];
  };
  if (joint >= kSmplJointCount && body.hands.empty()) return generic_offset(joint, body.height);
  const int parent = parent_of(joint);
  return parent < 0 ? place(joint) : Eigen::Vector3d(place(joint) - place(parent));
}

}  // namespace

std::vector<int> smpl_skeleton_order(bool fingers) {
  std::vector<int> order;
  for (const int joint : kDepthFirst) {
    order.push_back(joint);
    if (!fingers || joint < kLeftWristJoint) continue;
    const int first = kSmplJointCount + (joint == kLeftWristJoint ? 0 : kJointsPerHand);
    for (int i = 0; i < kJointsPerHand; ++i) order.push_back(first + i);
  }
  return order;
}

std::shared_ptr<const Skeleton> smpl_skeleton(const SmplRestBody& body, bool fingers) {
  std::array<int, kSmplJointCount + kSmplHandJointCount> place{};  // in the skeleton, of each joint
  std::vector<Joint> joints;
  for (const int index : smpl_skeleton_order(fingers)) {
    place[index] = static_cast<int>(joints.size());
    const int parent = parent_of(index);
    Joint joint;
    joint.name = name_of(index);
    joint.offset = offset_of(body, index);
    joint.channels = {Channel::kZRotation, Channel::kYRotation, Channel::kXRotation};
    if (parent < 0) {
      joint.channels.insert(joint.channels.begin(),
                            {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition});
    } else {
      joint.parent = place[parent];
    }
    for (std::size_t tip = 0; tip < kSmplTipJoints.size(); ++tip) {
      if (kSmplTipJoints[tip] == index)
        joint.end_sites.push_back(body.tips[tip] - body.joints[index]);
    }
    joints.push_back(std::move(joint));
  }
  return std::make_shared<const Skeleton>(std::move(joints));
}

void pose_smpl_skeleton(std::span<const int> order, std::span<const Eigen::Vector3d> rotations,
                        std::span<const Eigen::Vector3d> hand_rotations, bool y_is_up,
                        std::span<Eigen::Quaterniond> joints, Eigen::Vector3d& pelvis) {
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    const auto index = static_cast<std::size_t>(order[joint]);
    joints[joint] = exp_so3(index < kSmplJointCount ? rotations[index]
                                                    : hand_rotations[index - kSmplJointCount]);
  }
  if (!y_is_up) return;
  // exact: x stays, y becomes z
  pelvis = Eigen::Vector3d(pelvis.x(), -pelvis.z(), pelvis.y());
  joints[0] = Eigen::Quaterniond(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0) * joints[0];
}

}  // namespace retarget
