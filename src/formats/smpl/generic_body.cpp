#include <Eigen/Core>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/smpl/smpl_body.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// A position as fractions of the height: left of the midline, above the floor, forward.
struct Place {
  double left, up, forward;
};

// Heights of ankle, knee, hip and shoulder, lengths of hand and foot: R. Drillis, R. Contini, Body
// segment parameters (1966), as in D. Winter, Biomechanics and Motor Control of Human Movement.
// Upper arm, forearm and the end of the breastbone (spine3): P. de Leva, Adjustments to
// Zatsiorsky-Seluyanov's segment inertia parameters (1996), means of women and men. Hip centres: A.
// Bell et al., A comparison of the accuracy of several hip center location prediction methods
// (1990). The other values are assumptions in between, listed in docs/smpl.md.
constexpr double kHipWidth = 0.050;
constexpr double kAnkle = 0.039;
constexpr double kKnee = 0.285;
constexpr double kHip = 0.530;
constexpr double kShoulder = 0.818;
constexpr double kShoulderWidth = 0.100;
constexpr double kElbowWidth = kShoulderWidth + 0.160;
constexpr double kWristWidth = kElbowWidth + 0.153;
constexpr double kFingerWidth = kWristWidth + 0.108;
constexpr double kHeelBehindAnkle = 0.038;
constexpr double kFootLength = 0.152;
constexpr double kBall = 0.73 * kFootLength - kHeelBehindAnkle;
constexpr double kToes = kFootLength - kHeelBehindAnkle;

constexpr Place kPelvis = {0, 0.550, 0};
constexpr Place kSpine1 = {0, 0.580, 0}, kSpine2 = {0, 0.670, 0}, kSpine3 = {0, 0.738, 0};
constexpr Place kNeck = {0, 0.848, 0}, kHead = {0, 0.912, 0}, kCrown = {0, 1, 0};
constexpr Place kLeftHip = {kHipWidth, kHip, 0};
constexpr Place kLeftKnee = {kHipWidth, kKnee, 0};
constexpr Place kLeftAnkle = {kHipWidth, kAnkle, 0};
constexpr Place kLeftFoot = {kHipWidth, 0.012, kBall};
constexpr Place kLeftToeTip = {kHipWidth, 0.006, kToes};
constexpr Place kLeftCollar = {0.012, 0.822, 0};
constexpr Place kLeftShoulder = {kShoulderWidth, kShoulder, 0};
constexpr Place kLeftElbow = {kElbowWidth, kShoulder, 0};
constexpr Place kLeftWrist = {kWristWidth, kShoulder, 0};
constexpr Place kLeftFingerTip = {kFingerWidth, kShoulder, 0};

// In the order of kSmplJointNames; a left joint also represents the right one that follows it.
constexpr std::array kJoints = {kPelvis,    kLeftHip,      kSpine1,    kLeftKnee, kSpine2,
                                kLeftAnkle, kSpine3,       kLeftFoot,  kNeck,     kLeftCollar,
                                kHead,      kLeftShoulder, kLeftElbow, kLeftWrist};
// In the order of SmplTip; a left tip also represents the right one.
constexpr std::array kTips = {kCrown, kLeftToeTip, kLeftFingerTip};

// Position relative to the pelvis, metres.
Eigen::Vector3d position(const Place& place, double height) {
  return height * Eigen::Vector3d(place.left - kPelvis.left, place.up - kPelvis.up,
                                  place.forward - kPelvis.forward);
}

void put_both_sides(std::span<const Place> places, double height,
                    std::span<Eigen::Vector3d> positions) {
  auto next = positions.begin();
  for (const Place& place : places) {
    *next++ = position(place, height);
    if (place.left > 0.0) *next++ = position({-place.left, place.up, place.forward}, height);
  }
}

}  // namespace

SmplRestBody generic_smpl_rest_body(double height) {
  SmplRestBody body;
  put_both_sides(kJoints, height, body.joints);
  put_both_sides(kTips, height, body.tips);
  body.height = height;
  return body;
}

double smpl_height_of_betas(std::span<const double> betas) {
  constexpr double kMean = 1.66, kPerBeta = 0.1;
  return kMean + (betas.empty() ? 0.0 : kPerBeta * betas.front());
}

bool is_human_height(double height) {
  constexpr double kMin = 0.5, kMax = 2.5;
  return height >= kMin && height <= kMax;
}

std::optional<SmplRestBody> smpl_rest_body_of_offsets(std::span<const Eigen::Vector3d> offsets) {
  constexpr double kLongestBone = 1.0, kLeastTrunk = 0.2, kLeastLeg = 0.2;
  SmplRestBody body;
  for (int joint = 0; joint < kSmplJointCount; ++joint) {
    if (joint > 0 && !(offsets[joint].norm() < kLongestBone)) return std::nullopt;
    const int parent = kSmplParents[joint];
    body.joints[joint] =
        parent < 0 ? Eigen::Vector3d(0, 0, 0) : body.joints[parent] + offsets[joint];
  }
  constexpr int kLeftHipJoint = 1, kRightHipJoint = 2, kLeftAnkleJoint = 7, kRightAnkleJoint = 8,
                kHeadJoint = 15, kLeftElbowJoint = 18, kRightElbowJoint = 19;
  const auto& at = body.joints;
  const double ankles = 0.5 * (at[kLeftAnkleJoint] + at[kRightAnkleJoint]).y();
  const bool stands = at[kHeadJoint].y() > kLeastTrunk && ankles < -kLeastLeg &&
                      at[kLeftHipJoint].x() > at[kRightHipJoint].x() &&
                      at[kLeftElbowJoint].x() > at[kLeftHipJoint].x() &&
                      at[kRightElbowJoint].x() < at[kRightHipJoint].x();
  if (!stands) return std::nullopt;
  body.height = (at[kHeadJoint].y() - ankles) / (kHead.up - kAnkle);
  const SmplRestBody generic = generic_smpl_rest_body(body.height);
  for (int tip = 0; tip < kSmplTipCount; ++tip) {
    const int joint = kSmplTipJoints[tip];
    body.tips[tip] = at[joint] + generic.tips[tip] - generic.joints[joint];
  }
  return body;
}

// Bones: A. Buryanov, V. Kotiuk, Proportions of hand segments, International Journal of Morphology
// 28 (2010); the first bone of the thumb is its metacarpal. Knuckle positions are assumed: the
// metacarpals of that table after 25 mm of carpal bones.
const std::array<GenericFinger, kFingerCount>& generic_hand() {
  static const Eigen::Vector3d kAhead = Eigen::Vector3d::UnitX();
  static const std::array<GenericFinger, kFingerCount> kHand = {
      {{{0.025, 0.022, 0.012},
        Eigen::Vector3d(0.75, 0.55, 0.35).normalized(),
        {0.0462, 0.0316, 0.0256}},
       {{0.090, 0.025, 0.0}, kAhead, {0.0398, 0.0224, 0.0197}},
       {{0.092, 0.005, 0.0}, kAhead, {0.0446, 0.0263, 0.0214}},
       {{0.085, -0.014, 0.0}, kAhead, {0.0414, 0.0257, 0.0213}},
       {{0.078, -0.032, 0.0}, kAhead, {0.0327, 0.0181, 0.0197}}}};
  return kHand;
}

namespace {

// Left leg, right leg, trunk and head, left arm, right arm.
constexpr std::array<int, kSmplJointCount> kDepthFirst = {
    0, 1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12, 15, 13, 16, 18, 20, 14, 17, 19, 21};

constexpr int kLeftWristJoint = 20;
constexpr int kJointsPerFinger = 3;
constexpr int kJointsPerHand = kSmplHandJointCount / 2;

struct SmplFinger {
  Finger finger;
  std::string_view name;
};
// In the order of the models.
constexpr std::array<SmplFinger, kFingerCount> kFingersInOrder = {{{Finger::kIndex, "index"},
                                                                   {Finger::kMiddle, "middle"},
                                                                   {Finger::kLittle, "pinky"},
                                                                   {Finger::kRing, "ring"},
                                                                   {Finger::kThumb, "thumb"}}};

// Position of a hand joint, by its index among the hand joints.
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

// Offset to the parent in the models' axes: palms down, thumbs forward.
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
  std::array<int, kSmplJointCount + kSmplHandJointCount> place{};  // Index in the skeleton.
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
  // Exact rotation: x stays, y becomes z.
  pelvis = Eigen::Vector3d(pelvis.x(), -pelvis.z(), pelvis.y());
  joints[0] = Eigen::Quaterniond(std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0) * joints[0];
}

}  // namespace retarget
