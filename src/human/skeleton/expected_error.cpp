#include "human/skeleton/expected_error.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// Bones whose axes a movement can show.
constexpr std::array kShownBones = {Bone::kHips,        Bone::kSpine2,     Bone::kLeftUpLeg,
                                    Bone::kLeftLeg,     Bone::kLeftToe,    Bone::kLeftArm,
                                    Bone::kLeftForeArm, Bone::kRightUpLeg, Bone::kRightLeg,
                                    Bone::kRightToe,    Bone::kRightArm,   Bone::kRightForeArm};

// Angle of a rotation, degrees.
double degrees_of(const Eigen::Matrix3d& turn) {
  constexpr double kDegreesPerRad = 57.295779513082321;
  const Eigen::Vector3d sine(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0),
                             turn(1, 0) - turn(0, 1));
  return kDegreesPerRad * portable::atan2(sine.norm(), turn.trace() - 1.0);
}

// Weighted root mean square over the shown bones that have both axes.
template <typename Angle, typename Weight>
double mean_square_root(const JointFromBone& a, const JointFromBone& b, const Angle& angle,
                        const Weight& weight) {
  double sum = 0.0, weights = 0.0;
  for (const Bone bone : kShownBones) {
    if (!a[bone] || !b[bone]) continue;
    const double degrees = angle(bone);
    sum += weight(bone) * degrees * degrees;
    weights += weight(bone);
  }
  return weights > 0.0 ? std::sqrt(sum / weights) : 0.0;
}

}  // namespace

double expected_error(const LearnedAxes& learned) {
  return mean_square_root(
      learned.axes, learned.axes, [&](Bone bone) { return learned.error[bone]; },
      [](Bone) { return 1.0; });
}

double expected_error_of_pose(const JointFromBone& axes, double off, const LearnedAxes& learned) {
  const double shown = expected_error(axes, learned);
  // A pose near a T-pose shows the axes of every bone, one as far as kFar shows nothing.
  constexpr double kFar = 3.0 * kNearlyT;
  const double share = std::clamp((off - kNearlyT) / (kFar - kNearlyT), 0.0, 1.0);
  double bones = 0.0, hidden = 0.0, squares = 0.0;
  for (const Bone bone : kShownBones) {
    if (!axes[bone] || !learned.axes[bone]) continue;
    bones += 1.0;
    if (learned.is_learned(bone)) continue;
    hidden += 1.0;
    squares += share * learned.error[bone] * share * learned.error[bone];
  }
  if (!(share > 0.0) || !(hidden > 0.0)) return shown;
  return std::max(shown, std::sqrt(((bones - hidden) * shown * shown + squares) / bones));
}

double expected_error(const JointFromBone& axes, const LearnedAxes& learned) {
  const auto beyond = [&](Bone bone) {
    const double apart = degrees_of(axes[bone]->transpose() * *learned.axes[bone]);
    return std::sqrt(std::max(0.0, apart * apart - learned.error[bone] * learned.error[bone]));
  };
  return mean_square_root(axes, learned.axes, beyond, [&](Bone bone) {
    return 1.0 / (learned.error[bone] * learned.error[bone]);
  });
}

double angle_between_axes(const JointFromBone& a, const JointFromBone& b) {
  return mean_square_root(
      a, b, [&](Bone bone) { return degrees_of(a[bone]->transpose() * *b[bone]); },
      [](Bone) { return 1.0; });
}

}  // namespace retarget
