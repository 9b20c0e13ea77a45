#include "robot/limb_joints.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "retarget/pose.h"
#include "robot/model_values.h"

namespace retarget {
namespace {

// the part of a vector across a unit axis
Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis) {
  return vector - vector.dot(axis) * axis;
}

double distance_from_axis(const TreeState& posed, int joint, const Eigen::Vector3d& point) {
  return (point - posed.anchor(joint)).cross(posed.axis(joint)).norm();
}

Eigen::Vector3d centre_of_mass(const mjModel& model, const TreeState& posed, int body) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double mass = 0.0;
  for (const int part : posed.tree->rigid_group(body)) {
    sum += model.body_mass[part] * (posed.world_from_body(part) * vector_at(model.body_ipos, part));
    mass += model.body_mass[part];
  }
  return mass > 0.0 ? Eigen::Vector3d(sum / mass) : posed.world_from_body(body).translation;
}

bool carries_another(const Robot& robot, int body) {
  return std::ranges::any_of(robot.bodies(), [&](const RobotBody& b) { return b.parent == body; });
}

}  // namespace

std::size_t joints_at_middle(const TreeState& posed, std::span<const int> joints,
                             const Eigen::Vector3d& middle) {
  constexpr double kNear = 0.25;
  constexpr double kFar = 0.5;
  for (std::size_t count = 0; count < joints.size(); ++count) {
    const auto rest = joints.subspan(count + 1);
    if (rest.empty()) return count;
    const Eigen::Vector3d meeting = common_point(posed, rest);
    const double length = (meeting - middle).norm();
    // a twist of the segment passes its ends as well, from afar
    const bool bends = !posed.slides(joints[count]) &&
                       (posed.anchor(joints[count]) - middle).norm() < kNear * length &&
                       distance_from_axis(posed, joints[count], meeting) > kFar * length;
    if (!bends) return count;
  }
  return 0;
}

bool all_pass(const TreeState& posed, std::span<const int> joints, const Eigen::Vector3d& point,
              double within) {
  return std::ranges::all_of(joints, [&](int joint) {
    return !posed.slides(joint) && distance_from_axis(posed, joint, point) < within;
  });
}

SegmentEnd segment_end(const Robot& robot, const TreeState& posed, const SegmentStart& start) {
  constexpr double kFarEnough = 0.35;
  constexpr double kBeyondMass = 2.0;
  constexpr double kOfUpper = 0.76;  // a human's forearm
  const auto& [body, root, middle, axis, beyond] = start;
  const Eigen::Vector3d upper = across(middle - root, axis);
  SegmentEnd end;
  double farthest = kFarEnough * upper.norm();
  for (const int part : posed.tree->rigid_group(body)) {
    const Eigen::Vector3d place = posed.world_from_body(part).translation;
    const double distance = across(place - middle, axis).norm();
    if (part == body || distance <= farthest || carries_another(robot, part)) continue;
    farthest = distance;
    end.point = place;
    end.body = part;
  }
  if (end.body) return end;
  end.estimated = true;
  const Eigen::Vector3d mass = across(centre_of_mass(*robot.model(), posed, body) - middle, axis);
  end.point = middle + kBeyondMass * mass;
  if ((end.point - middle).norm() >= kLeastSegment * upper.norm()) return end;
  for (const int joint : beyond) {
    const double along = posed.axis(joint).dot(upper.normalized());
    if (std::abs(along) < kTurnsAlong) continue;
    end.point = middle + (along < 0.0 ? -kOfUpper : kOfUpper) * upper.norm() * posed.axis(joint);
    break;
  }
  return end;
}

}  // namespace retarget
