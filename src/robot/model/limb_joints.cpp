#include "robot/model/limb_joints.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>

#include "retarget/pose.h"
#include "robot/model/model_values.h"

namespace retarget {
namespace {

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

Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis) {
  return vector - vector.dot(axis) * axis;
}

std::size_t joints_at_middle(const TreeState& posed, std::span<const int> joints,
                             const Eigen::Vector3d& middle) {
  constexpr double kNear = 0.25;
  constexpr double kOnePlace = 0.02;
  constexpr double kFar = 0.5;
  std::size_t at_middle = 0;
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
    const Eigen::Vector3d meeting = common_point(posed, joints.subspan(i + 1));
    const double length = (meeting - middle).norm();
    const double apart = (posed.anchor(joints[i]) - middle).norm();
    if (posed.slides(joints[i]) || apart >= kNear * length) break;
    // The axis of a twist joint passes both ends of the segment too, but its anchor may be far
    // away.
    if (distance_from_axis(posed, joints[i], meeting) > kFar * length) {
      at_middle = i + 1;
    } else if (apart >= kOnePlace * length) {
      break;
    }
  }
  return at_middle;
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
  constexpr double kOfUpper = 0.76;  // Forearm to upper arm length in humans.
  const auto& [body, root, middle, axis, beyond] = start;
  const Eigen::Vector3d upper = across(middle - root, axis);
  SegmentEnd end;
  double farthest = kFarEnough * upper.norm();
  const int own = robot.moved_body(body);
  for (const int part : posed.tree->rigid_group(body)) {
    const Eigen::Vector3d place = posed.world_from_body(part).translation;
    const double distance = across(place - middle, axis).norm();
    if (part == body || part == own || distance <= farthest || carries_another(robot, part))
      continue;
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
