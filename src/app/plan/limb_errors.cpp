#include "app/plan/limb_errors.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <numbers>

#include "retarget/human.h"
#include "retarget/robot.h"
#include "retarget/so3.h"
#include "solve/targets/limb_lengths.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Points that define the limbs of a robot.
struct LimbPlaces {
  BoneArray<int> body;  // -1: the robot has none.
  BoneArray<Vector3d> in_body;
};

LimbPlaces limb_places(const Robot& robot, const ResolvedConfig& config) {
  LimbPlaces places;
  const auto limbs = robot_limbs(robot, config);
  for (const Bone bone : kAllBones) {
    places.body[bone] = config.body_of(bone);
    places.in_body[bone] = limbs ? limbs->body_from_joint[bone] : Vector3d(Vector3d::Zero());
  }
  return places;
}

}  // namespace

std::vector<LimbErrors> limb_errors(const Motion& motion) {
  const Robot& robot = motion.clip.robot();
  const HumanClip human = to_human(*motion.source, motion.plan.human.calibration);
  const LimbPlaces places = limb_places(robot, motion.plan.config);
  std::vector<Pose> bodies(robot.bodies().size());
  std::vector<LimbErrors> all(static_cast<std::size_t>(motion.clip.frame_count()));
  for (int frame = 0; frame < motion.clip.frame_count(); ++frame) {
    forward_kinematics(robot, motion.clip.qpos(frame), bodies);
    LimbErrors& errors = all[static_cast<std::size_t>(frame)];
    errors.fill(0.0);
    for (std::size_t i = 0; i < kLimbSegments.size(); ++i) {
      const LimbSegment& segment = kLimbSegments[i];
      const bool known = std::ranges::all_of(
          segment.bones(), [&](Bone bone) { return human.has(bone) && places.body[bone] >= 0; });
      if (!known) continue;
      const Vector3d of_human =
          segment.direction([&](Bone bone) { return human.frame(frame)[bone].translation; });
      const Vector3d of_robot = segment.direction([&](Bone bone) -> Vector3d {
        return bodies[static_cast<std::size_t>(places.body[bone])] * places.in_body[bone];
      });
      if (of_human.norm() < 1e-9 || of_robot.norm() < 1e-9) continue;
      errors[i] = 180.0 / std::numbers::pi * angle_between(of_human, of_robot);
    }
  }
  return all;
}

double mean_error(const LimbErrors& errors) {
  double sum = 0.0;
  for (const double error : errors) sum += error;
  return sum / static_cast<double>(errors.size());
}

double largest_increase(const LimbErrors& from, const LimbErrors& to) {
  double largest = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) largest = std::max(largest, to[i] - from[i]);
  return largest;
}

}  // namespace retarget
