#include "solve/targets/limb_aim.h"

#include <algorithm>

namespace retarget {
namespace {

constexpr double kMinLength = 1e-6;  // Metres; also used for a sine.
constexpr double kOwnShare = 0.1;    // Share of the upper bone's own axis; the sine of a bend of 6
                                     // degrees.

// Rotation with X along a direction and Z as close to the hinge as possible.
std::optional<Eigen::Quaterniond> bone_along(const Eigen::Vector3d& along,
                                             const Eigen::Vector3d& hinge) {
  const Eigen::Vector3d y = hinge.cross(along);
  const double clear = y.norm();
  if (!(clear > kMinLength)) return std::nullopt;
  Eigen::Matrix3d axes;
  axes.col(0) = along;
  axes.col(1) = y / clear;
  axes.col(2) = along.cross(axes.col(1));
  return Eigen::Quaterniond(axes);
}

}  // namespace

std::optional<LimbAim> aim_limb(const Pose& upper, const Pose& lower, const Pose& end) {
  const Eigen::Vector3d first = lower.translation - upper.translation;
  const Eigen::Vector3d second = end.translation - lower.translation;
  const double first_length = first.norm(), second_length = second.norm();
  if (!(first_length > kMinLength && second_length > kMinLength)) return std::nullopt;
  const Eigen::Vector3d u = first / first_length, f = second / second_length;
  const Eigen::Vector3d own = upper.rotation.normalized() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d plane = -u.cross(f);
  // A hinge cannot bend backwards, so a limb that does counts as straight.
  const double back = std::min(0.0, plane.dot(own));
  const Eigen::Vector3d hinge = (kOwnShare - back) * own + plane;
  const auto first_turn = bone_along(u, hinge), second_turn = bone_along(f, hinge);
  if (!first_turn || !second_turn) return std::nullopt;
  return LimbAim{*first_turn, *second_turn};
}

}  // namespace retarget
