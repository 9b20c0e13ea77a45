#include <array>
#include <span>

#include "smpl/smpl_body.h"

namespace retarget {
namespace {

// a place as fractions of the height: to the left of the middle, above the floor, forward
struct Place {
  double left, up, forward;
};

// Heights of ankle, knee, hip and shoulder, lengths of hand and foot: R. Drillis, R. Contini, Body
// segment parameters (1966), as in D. Winter, Biomechanics and Motor Control of Human Movement.
// Upper arm, forearm and the end of the breastbone (spine3): P. de Leva, Adjustments to
// Zatsiorsky-Seluyanov's segment inertia parameters (1996), means of women and men. Hip centres:
// A. Bell et al., A comparison of the accuracy of several hip center location prediction methods
// (1990). The others are assumptions between these; docs/smpl.md tells which.
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

// by kSmplJointNames, each left joint for the right one behind it as well
constexpr std::array kJoints = {kPelvis,    kLeftHip,      kSpine1,    kLeftKnee, kSpine2,
                                kLeftAnkle, kSpine3,       kLeftFoot,  kNeck,     kLeftCollar,
                                kHead,      kLeftShoulder, kLeftElbow, kLeftWrist};
// by SmplTip, the same
constexpr std::array kTips = {kCrown, kLeftToeTip, kLeftFingerTip};

// from the pelvis, in metres
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

}  // namespace retarget
