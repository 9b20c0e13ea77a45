#include "retarget/two_bone_leg.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "retarget/so3.h"
#include "retarget/spline.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

// Rotates a joint by a world rotation.
void turn_joint(Clip& clip, int frame, int joint, const Eigen::Quaterniond& turn,
                const std::vector<Pose>& world_from_joint) {
  const int parent = clip.skeleton().joint(joint).parent;
  const Eigen::Quaterniond above =
      parent < 0 ? Eigen::Quaterniond::Identity() : world_from_joint[parent].rotation;
  Eigen::Quaterniond& rotation = clip.rotations(frame)[joint];
  const Eigen::Quaterniond turned = above.conjugate() * turn * above * rotation;
  rotation = turned.normalized();
}

// Returns the world axis of the knee's bend: taken from the current bend, or from the hinge if the
// leg is almost straight; blended in between.
Eigen::Vector3d bend_axis(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
                          const Eigen::Vector3d& hinge) {
  constexpr double kStraight = 0.1, kBent = 0.35;  // Sines of the bend.
  const Eigen::Vector3d across = thigh.cross(shin) / (thigh.norm() * shin.norm());
  const double bent = smooth_step(kStraight, kBent, across.norm());
  if (bent == 0.0) return hinge;
  // A hyperextended knee has the opposite axis; flip it.
  const double side = across.dot(hinge) < 0.0 ? -1.0 : 1.0;
  return (bent * side * across.normalized() + (1.0 - bent) * hinge).normalized();
}

// Returns the rotation of the shin about the axis that brings hip and ankle to a given distance.
//
// With R(angle) shin = along + cos (shin - along) + sin (axis x shin) the distance depends on thigh
// . R shin = fixed + amplitude cos(angle - straightest).
double bend_to(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
               const Eigen::Vector3d& axis, double distance) {
  const Eigen::Vector3d along = axis.dot(shin) * axis;
  const double fixed = thigh.dot(along), cosine = thigh.dot(shin - along),
               sine = thigh.dot(axis.cross(shin));
  const double amplitude = std::sqrt(cosine * cosine + sine * sine);
  if (!(amplitude > 0.0)) return 0.0;
  const double straightest = portable::atan2(sine, cosine);
  const double wanted = 0.5 * (distance * distance - thigh.squaredNorm() - shin.squaredNorm());
  const double share = std::clamp((wanted - fixed) / amplitude, -1.0, 1.0);
  const double bend = portable::atan2(std::sqrt(1.0 - share * share), share);
  if (straightest <= 0.0) return straightest + bend;
  // A hyperextended knee is not bent backwards further. On the way to a forward bend the leg is
  // almost straight, so the error in its length is negligible.
  constexpr double kTurned = 0.15;
  const double turned = smooth_step(0.0, std::min(2.0 * straightest, kTurned), bend - straightest);
  return straightest + turned * bend - (1.0 - turned) * std::min(bend, straightest);
}

}  // namespace

Eigen::Vector3d learned_hinge(const Clip& clip, const LegJoints& joints,
                              const Eigen::Vector3d& fallback) {
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, poses);
    const Pose& knee = poses[joints.knee];
    const Eigen::Vector3d thigh = knee.translation - poses[joints.hip].translation;
    const Eigen::Vector3d shin = poses[joints.ankle].translation - knee.translation;
    const double lengths = thigh.norm() * shin.norm();
    if (!(lengths > 0.0)) continue;
    const Eigen::Vector3d across = thigh.cross(shin) / lengths;
    // The bend axis of a nearly straight leg is noise.
    constexpr double kBent = 0.35;
    if (across.norm() < kBent) continue;
    sum += knee.rotation.conjugate() * across;
    weights += across.norm();
  }
  constexpr double kOneAxis = 0.7;
  return sum.norm() > kOneAxis * weights ? Eigen::Vector3d(sum.normalized()) : fallback;
}

LegReach LegReach::of(double length, double own, double moved, double soft, double farthest) {
  constexpr double kMoved = 0.04;  // Fraction of the leg's length.
  const double free = soft * length;
  const double as_it_is = 1.0 - smooth_step(0.0, kMoved * length, moved);
  const double begin = free + as_it_is * std::max(own - free, 0.0);
  const double share = (farthest - soft) / (1.0 - soft);
  return {begin, share * std::max(length - begin, 0.0)};
}

double LegReach::at(double wanted) const {
  const double beyond = wanted - begin;
  if (beyond <= 0.0) return wanted;
  // The curve leaves the identity with zero curvature.
  return begin + beyond * room / std::sqrt(beyond * beyond + room * room);
}

double TwoBoneLeg::reach(Clip& clip, int frame, const Pose& world_from_ankle,
                         const LegReach& stretch) const {
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, frame, poses);
  const Eigen::Vector3d hip = poses[joints_.hip].translation;
  const Eigen::Vector3d thigh = poses[joints_.knee].translation - hip;
  const Eigen::Vector3d shin = poses[joints_.ankle].translation - poses[joints_.knee].translation;
  const Eigen::Vector3d wanted = world_from_ankle.translation - hip;
  // Bones of zero length cannot rotate.
  if (!(thigh.norm() * shin.norm() > 0.0)) {
    return (poses[joints_.ankle].translation - world_from_ankle.translation).norm();
  }
  const double shortest = 1.001 * std::abs(thigh.norm() - shin.norm());
  const double distance = std::max(stretch.at(wanted.norm()), shortest);

  const Eigen::Vector3d axis = bend_axis(thigh, shin, poses[joints_.knee].rotation * hinge_);
  const double bend = bend_to(thigh, shin, axis, distance);
  turn_joint(clip, frame, joints_.knee, exp_so3(axis * bend), poses);

  forward_kinematics(clip, frame, poses);
  const Eigen::Vector3d now = poses[joints_.ankle].translation - hip;
  turn_joint(clip, frame, joints_.hip, rotation_between(now, wanted), poses);

  forward_kinematics(clip, frame, poses);
  const Eigen::Quaterniond left =
      world_from_ankle.rotation * poses[joints_.ankle].rotation.conjugate();
  turn_joint(clip, frame, joints_.ankle, left, poses);
  return (poses[joints_.ankle].translation - world_from_ankle.translation).norm();
}

}  // namespace retarget
