#include "edit/two_bone_leg.h"

#include <algorithm>
#include <cmath>

#include "retarget/math/so3.h"
#include "retarget/math/trigonometry.h"
#include "retarget/motion/forward_kinematics.h"

namespace retarget {
namespace {

// turns a joint by a rotation of the world
void turn_joint(Clip& clip, int frame, int joint, const Eigen::Quaterniond& turn,
                const std::vector<Pose>& world_from_joint) {
  const int parent = clip.skeleton().joint(joint).parent;
  const Eigen::Quaterniond above =
      parent < 0 ? Eigen::Quaterniond::Identity() : world_from_joint[parent].rotation;
  Eigen::Quaterniond& rotation = clip.rotations(frame)[joint];
  const Eigen::Quaterniond turned = above.conjugate() * turn * above * rotation;
  rotation = turned.normalized();
}

// angle at the knee between thigh and shin, of a triangle with these sides
double knee_angle(double thigh, double shin, double distance) {
  const double cosine = std::clamp(
      (thigh * thigh + shin * shin - distance * distance) / (2.0 * thigh * shin), -1.0, 1.0);
  return portable::atan2(std::sqrt(1.0 - cosine * cosine), cosine);
}

}  // namespace

double TwoBoneLeg::length(const std::vector<Pose>& world_from_joint) const {
  const Eigen::Vector3d& knee = world_from_joint[joints_.knee].translation;
  return (knee - world_from_joint[joints_.hip].translation).norm() +
         (world_from_joint[joints_.ankle].translation - knee).norm();
}

double TwoBoneLeg::reach(Clip& clip, int frame, const Pose& world_from_ankle,
                         double longest) const {
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, frame, poses);
  const Eigen::Vector3d hip = poses[joints_.hip].translation;
  const Eigen::Vector3d thigh = poses[joints_.knee].translation - hip;
  const Eigen::Vector3d shin = poses[joints_.ankle].translation - poses[joints_.knee].translation;
  const Eigen::Vector3d wanted = world_from_ankle.translation - hip;
  const double shortest = 1.001 * std::abs(thigh.norm() - shin.norm());
  const double distance = std::clamp(wanted.norm(), shortest, std::max(longest, shortest));

  // the knee bends about the axis across thigh and shin, of a straight leg about its own
  constexpr double kStraight = 1e-3;
  Eigen::Vector3d axis = thigh.cross(shin);
  if (axis.norm() < kStraight * thigh.norm() * shin.norm()) {
    axis = poses[joints_.knee].rotation * bend_axis_;
  }
  const double bend = knee_angle(thigh.norm(), shin.norm(), (thigh + shin).norm()) -
                      knee_angle(thigh.norm(), shin.norm(), distance);
  turn_joint(clip, frame, joints_.knee, exp_so3(axis.normalized() * bend), poses);

  forward_kinematics(clip, frame, poses);
  const Eigen::Vector3d now = poses[joints_.ankle].translation - hip;
  turn_joint(clip, frame, joints_.hip, Eigen::Quaterniond::FromTwoVectors(now, wanted), poses);

  forward_kinematics(clip, frame, poses);
  const Eigen::Quaterniond left =
      world_from_ankle.rotation * poses[joints_.ankle].rotation.conjugate();
  turn_joint(clip, frame, joints_.ankle, left, poses);
  return (poses[joints_.ankle].translation - world_from_ankle.translation).norm();
}

}  // namespace retarget
