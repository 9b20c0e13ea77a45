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

constexpr Place mirrored(const Place& place) {
  return {-place.left, place.up, place.forward};
}

constexpr Place kPelvis = {0, 0.550, 0};
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

// by kSmplJointNames
constexpr std::array<Place, kSmplJointCount> kJoints = {kPelvis,
                                                        kLeftHip,
                                                        mirrored(kLeftHip),
                                                        Place{0, 0.580, 0},  // spine1
                                                        kLeftKnee,
                                                        mirrored(kLeftKnee),
                                                        Place{0, 0.670, 0},  // spine2
                                                        kLeftAnkle,
                                                        mirrored(kLeftAnkle),
                                                        Place{0, 0.738, 0},  // spine3
                                                        kLeftFoot,
                                                        mirrored(kLeftFoot),
                                                        Place{0, 0.848, 0},  // neck
                                                        kLeftCollar,
                                                        mirrored(kLeftCollar),
                                                        Place{0, 0.912, 0},  // head
                                                        kLeftShoulder,
                                                        mirrored(kLeftShoulder),
                                                        kLeftElbow,
                                                        mirrored(kLeftElbow),
                                                        kLeftWrist,
                                                        mirrored(kLeftWrist)};

// by SmplTip
constexpr std::array<Place, kSmplTipCount> kTips = {
    Place{0, 1, 0}, kLeftToeTip, mirrored(kLeftToeTip), kLeftFingerTip, mirrored(kLeftFingerTip)};

// from the pelvis, in metres
Eigen::Vector3d position(const Place& place, double height) {
  return height * Eigen::Vector3d(place.left - kPelvis.left, place.up - kPelvis.up,
                                  place.forward - kPelvis.forward);
}

}  // namespace

SmplRestBody generic_smpl_rest_body(double height) {
  SmplRestBody body;
  for (int i = 0; i < kSmplJointCount; ++i) body.joints[i] = position(kJoints[i], height);
  for (int i = 0; i < kSmplTipCount; ++i) body.tips[i] = position(kTips[i], height);
  body.height = height;
  return body;
}

}  // namespace retarget
