#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "judge/quality/report_parts.h"
#include "retarget/kinematic_tree.h"
#include "retarget/measure.h"
#include "retarget/robot.h"
#include "retarget/statistics.h"
#include "solve/dynamics/motion_dynamics.h"

namespace retarget {
namespace {

// Name and amount of the larger unexplained part of a sample: the force, named by its largest world
// component, or the horizontal torque.
std::pair<std::string, double> missing(const DynamicsSample& sample) {
  static constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
  const Eigen::Vector3d& force = sample.unexplained_force;
  if (force.norm() < sample.torque_as_force()) {
    return {"torque", sample.unexplained_torque.head<2>().norm()};
  }
  int axis = 0;
  force.cwiseAbs().maxCoeff(&axis);
  const std::string sign = force[axis] < 0.0 ? "-" : "+";
  return {"force along " + sign + std::string(kAxes[static_cast<std::size_t>(axis)]), force.norm()};
}

// The finite values of a quantity. Non-finite samples are bad (DynamicsSample::is_bad()).
struct Series {
  std::vector<double> values;

  void add(double value) {
    if (std::isfinite(value)) values.push_back(value);
  }
};

void measure_unexplained(const ReportBuilder& draft, const MotionDynamics& dynamics) {
  FaultList faults("dynamics_bad_pct", "of the weight"), torques("dynamics_bad_pct", "m x weight");
  Series force, torque, flight_force, flight_torque;
  int bad = 0, last_frame = -1;
  for (std::size_t i = 0; i < dynamics.samples.size(); ++i) {
    const DynamicsSample& sample = dynamics.samples[i];
    force.add(100.0 * sample.unexplained_force.norm());
    torque.add(kInCm * sample.unexplained_torque.head<2>().norm());
    if (!sample.supported) {
      flight_force.add(100.0 * sample.unexplained_force.norm());
      flight_torque.add(kInCm * sample.unexplained_torque.norm());
    }
    if (!sample.is_bad()) continue;
    ++bad;
    const int frame = dynamics.frame_of(i);
    // One fault per frame, for its first bad sample.
    if (std::exchange(last_frame, frame) == frame) continue;
    const auto [what, amount] = missing(sample);
    (what == "torque" ? torques : faults).add(what, frame, amount);
  }
  draft.set("dynamics_bad_pct", percent(bad, static_cast<double>(dynamics.samples.size())));
  if (!force.values.empty()) {
    draft.set("unexplained_force_pct", mean(force.values), percentile(force.values, 95.0));
    draft.set("unexplained_torque_cm", mean(torque.values), percentile(torque.values, 95.0));
  }
  if (!flight_force.values.empty()) {
    draft.set("flight_force_pct", mean(flight_force.values));
    draft.set("flight_torque_cm", mean(flight_torque.values));
  }
  faults.move_to(draft.report, draft.options.faults_per_metric);
  torques.move_to(draft.report, draft.options.faults_per_metric);
}

void measure_torques(const ReportBuilder& draft, const MotionDynamics& dynamics) {
  if (!dynamics.knows_torque_limits) return;
  const Robot& robot = draft.clip.robot();
  FaultList faults("torque_over_pct", "of its limit");
  Series ratios;
  int over = 0, last_frame = -1;
  for (std::size_t i = 0; i < dynamics.samples.size(); ++i) {
    const DynamicsSample& sample = dynamics.samples[i];
    ratios.add(sample.torque_ratio);
    if (sample.torque_ratio <= 1.0) continue;
    ++over;
    if (sample.torque_link < 0) continue;  // The torque ratio is not finite.
    const int frame = dynamics.frame_of(i);
    if (std::exchange(last_frame, frame) == frame) continue;
    const int joint = robot.tree().links()[static_cast<std::size_t>(sample.torque_link)].joint;
    faults.add(robot.joints()[static_cast<std::size_t>(joint)].name, frame, sample.torque_ratio);
  }
  draft.set("torque_over_pct", percent(over, static_cast<double>(dynamics.samples.size())));
  if (!ratios.values.empty()) {
    draft.set("torque_p99_ratio", percentile(std::move(ratios.values), 99.0));
  }
  faults.move_to(draft.report, draft.options.faults_per_metric);
}

void measure_support(const ReportBuilder& draft, const MotionDynamics& dynamics) {
  Series margin, friction;
  for (const DynamicsSample& sample : dynamics.samples) {
    margin.add(kInCm * sample.zmp_margin);
    friction.add(sample.friction);
  }
  if (margin.values.empty()) return;
  draft.set("zmp_margin_p5_cm", percentile(std::move(margin.values), 5.0));
  draft.set("friction_p95", percentile(std::move(friction.values), 95.0));
}

}  // namespace

void add_dynamics(const RobotClip& clip, QualityReport& report, const SceneWorld* scene,
                  const QualityOptions& options) {
  if (clip.robot().fixed_base()) return;
  const MotionDynamics dynamics = analyse_dynamics(clip, scene);
  if (dynamics.samples.empty()) return;
  const ReportBuilder draft{clip, options, report};
  measure_unexplained(draft, dynamics);
  measure_torques(draft, dynamics);
  measure_support(draft, dynamics);
  std::ranges::sort(report.values, {}, &MetricValue::metric);
}

}  // namespace retarget
