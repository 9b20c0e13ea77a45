#include "judge/simulation/simulation_errors.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

MeanAndP95 summary_of(const std::vector<double>& values) {
  if (values.empty()) return {};
  return {mean(values), percentile(values, 95.0)};
}

}  // namespace

void set_errors(const RobotClip& reference, const RobotClip& simulated, int frames,
                SimulationReport& report) {
  const Robot& robot = reference.robot();
  TreeState wanted(robot.tree()), is(robot.tree());
  std::vector<double> joints, root, turn, bodies;
  for (int frame = 0; frame < frames; ++frame) {
    const auto a = reference.qpos(frame);
    const auto b = simulated.qpos(frame);
    wanted.update(a);
    is.update(b);
    root.push_back(100.0 * (is.origin() - wanted.origin()).norm());
    turn.push_back(kDegrees * log_so3(is.world_from_link[0].rotation *
                                      wanted.world_from_link[0].rotation.conjugate())
                                  .norm());
    for (const int j : robot.output_joints()) {
      const RobotJoint& joint = robot.joints()[j];
      if (joint.type != RobotJoint::Type::kHinge) continue;
      joints.push_back(kDegrees * std::abs(b[joint.qpos_address] - a[joint.qpos_address]));
    }
    for (std::size_t i = 0; i < is.world_from_link.size(); ++i) {
      bodies.push_back(
          100.0 *
          (is.world_from_link[i].translation - wanted.world_from_link[i].translation).norm());
    }
  }
  report.joint_deg = summary_of(joints);
  report.root_cm = summary_of(root);
  report.root_deg = summary_of(turn);
  report.body_cm = summary_of(bodies);
}

}  // namespace retarget
