#include "retarget/simulate.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "base/try.h"
#include "judge/simulation/physics_model.h"
#include "judge/simulation/reference_track.h"
#include "judge/simulation/whole_body_controller.h"
#include "retarget/kinematic_tree.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"
#include "robot/model/model_values.h"
#include "solve/dynamics/motion_dynamics.h"

namespace retarget {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

MeanAndP95 summary_of(const std::vector<double>& values) {
  if (values.empty()) return {};
  return {mean(values), percentile(values, 95.0)};
}

// Sets the tracking errors of the report.
// @param frames  number of frames to compare, from the first.
void set_errors(const RobotClip& reference, const RobotClip& simulated, int frames,
                SimulationReport& report) {
  const Robot& robot = reference.robot();
  TreeState expected(robot.tree()), actual(robot.tree());
  std::vector<double> joints, root, turn, bodies;
  for (int frame = 0; frame < frames; ++frame) {
    const auto a = reference.qpos(frame);
    const auto b = simulated.qpos(frame);
    expected.update(a);
    actual.update(b);
    root.push_back(100.0 * (actual.origin() - expected.origin()).norm());
    turn.push_back(kDegrees * log_so3(actual.world_from_link[0].rotation *
                                      expected.world_from_link[0].rotation.conjugate())
                                  .norm());
    for (const int j : robot.output_joints()) {
      const RobotJoint& joint = robot.joints()[j];
      if (joint.type != RobotJoint::Type::kHinge) continue;
      joints.push_back(kDegrees * std::abs(b[joint.qpos_address] - a[joint.qpos_address]));
    }
    for (std::size_t i = 0; i < actual.world_from_link.size(); ++i) {
      bodies.push_back(
          100.0 *
          (actual.world_from_link[i].translation - expected.world_from_link[i].translation).norm());
    }
  }
  report.joint_deg = summary_of(joints);
  report.root_cm = summary_of(root);
  report.root_deg = summary_of(turn);
  report.body_cm = summary_of(bodies);
}

using Eigen::Vector3d;

constexpr double kLongestStep = 0.002;  // Largest time step, seconds.
constexpr double kAtLimit = 0.999;      // Torque ratio above which a torque is at its limit.
constexpr double kOnFloor = 0.0005;     // Height up to which a sole point is on the floor, metres.
constexpr double kTooFast = 1e3;        // Speed of a diverged simulation, m/s or rad/s.
constexpr double kBrake = 0.02;         // Joint damping after a fall, share of the limit per rad/s.

Eigen::Quaterniond quaternion_at(const mjtNum* wxyz) {
  return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
}

class Simulator {
 public:
  Simulator(const RobotClip& reference, PhysicsModel physics, int steps_per_frame, double floor)
      : clip_(reference),
        robot_(reference.robot()),
        physics_(std::move(physics)),
        data_(mj_makeData(physics_.model.get())),
        steps_per_frame_(steps_per_frame),
        floor_(floor),
        size_(body_size(robot_)),
        track_(reference, steps_per_frame, floor),
        controller_(physics_, robot_),
        motion_(reference) {
    for (const Sole& sole : robot_.profile().soles) sole_count_ += sole.points.size();
  }

  Result<Simulation> run(const SimulateOptions& options) {
    begin();
    for (int step = 0; step < track_.step_count(); ++step) {
      const ReferenceState& reference = track_.at(step);
      const bool of_frame = step % steps_per_frame_ == 0;
      if (of_frame && options.is_stopped && options.is_stopped()) return interrupted_failure();
      if (!evaluate()) {
        if (!report_.fell) fall(step, "diverged");
        hold_from(step);
        break;
      }
      if (!report_.fell) check_fall(step, reference);
      if (of_frame) record(step / steps_per_frame_);
      advance(reference);
    }
    finish();
    return Simulation{std::move(motion_), std::move(report_)};
  }

 private:
  void begin() {
    const ReferenceState& start = track_.at(0);
    physics_.set_positions(start.motion.qpos, robot_, data_->qpos);
    physics_.set_rates(start.motion.velocity, data_->qvel);
    // The whole body starts with the velocity of the balancing shift.
    for (int k = 0; k < 2; ++k) data_->qvel[k] += start.shift_velocity[k];
    report_.robot = robot_.name();
    report_.frames = clip_.frame_count();
    report_.fps = clip_.rate().fps();
    report_.time_step = track_.time_step();
    report_.fall_time_s = report_.time_step * (track_.step_count() - 1);
    report_.knows_torque_limits = std::ranges::any_of(
        physics_.joints, [](const PhysicsJoint& j) { return std::isfinite(j.limit); });
  }

  // The first half of mj_step. Replaces its checks, for which MuJoCo prints warnings.
  // @return false if the simulation has diverged.
  bool evaluate() {
    const mjModel* model = physics_.model.get();
    for (int i = 0; i < model->nq; ++i) {
      if (!std::isfinite(data_->qpos[i])) return false;
    }
    for (int i = 0; i < model->nv; ++i) {
      if (!(std::abs(data_->qvel[i]) < kTooFast)) return false;
    }
    mj_fwdPosition(model, data_.get());
    mj_fwdVelocity(model, data_.get());
    return true;
  }

  void advance(const ReferenceState& reference) {
    const mjModel* model = physics_.model.get();
    if (report_.fell) {
      brake();
    } else {
      control(reference);
      measure_slip();
    }
    mj_fwdActuation(model, data_.get());
    mj_fwdAcceleration(model, data_.get());
    mj_fwdConstraint(model, data_.get());
    mj_implicit(model, data_.get());
  }

  void control(const ReferenceState& reference) {
    const ControlStep& step = controller_.compute(reference, track_.time_step(), data_.get());
    if (!step.converged) ++report_.unsolved_steps;
    double largest = 0.0;
    for (std::size_t i = 0; i < physics_.joints.size(); ++i) {
      const PhysicsJoint& joint = physics_.joints[i];
      data_->qfrc_applied[joint.dof] = step.torques[i];
      if (std::isfinite(joint.limit))
        largest = std::max(largest, std::abs(step.torques[i]) / joint.limit);
    }
    torque_ratios_.push_back(largest);
  }

  void brake() {
    for (const PhysicsJoint& joint : physics_.joints) {
      const double limit = std::isfinite(joint.limit) ? joint.limit : 50.0;
      data_->qfrc_applied[joint.dof] =
          std::clamp(-kBrake * limit * data_->qvel[joint.dof], -limit, limit);
    }
  }

  // Adds the speeds of the sole points on the floor; sole points are the first physics points.
  void measure_slip() {
    const bool is_first = last_points_.empty();
    last_points_.resize(sole_count_);
    for (std::size_t i = 0; i < std::min(sole_count_, physics_.points.size()); ++i) {
      const PhysicsPoint& point = physics_.points[i];
      const mjtNum* at = data_->xpos + 3L * point.body;
      const Vector3d now =
          Pose{quaternion_at(data_->xquat + 4L * point.body), {at[0], at[1], at[2]}} *
          point.in_body;
      const Vector3d last = std::exchange(last_points_[i], now);
      const double height = std::max(now.z(), is_first ? 1.0 : last.z());
      if (height - point.radius > kOnFloor) continue;
      slip_ += (now - last).head<2>().norm() / track_.time_step();
      ++slip_count_;
    }
  }

  void check_fall(int step, const ReferenceState& reference) {
    const std::vector<double>& reference_qpos = reference.motion.qpos;
    const Vector3d off(data_->qpos[0] - reference_qpos[0], data_->qpos[1] - reference_qpos[1],
                       data_->qpos[2] - reference_qpos[2]);
    const Vector3d up = Vector3d::UnitZ();
    const Vector3d current_up = quaternion_at(data_->qpos + 3).conjugate() * up;
    const Vector3d reference_up = root_rotation(reference_qpos).conjugate() * up;
    const double tilt = angle_between(current_up, reference_up) * 180.0 / std::numbers::pi;
    if (-off.z() > kFallHeight * size_) return fall(step, "height");
    if (tilt > kFallTilt) return fall(step, "tilt");
    if (off.head<2>().norm() > kLostDistance * size_) return fall(step, "distance");
  }

  void fall(int step, const char* reason) {
    report_.fell = true;
    report_.fall_frame = (step + steps_per_frame_ - 1) / steps_per_frame_;
    report_.fall_time_s = step * track_.time_step();
    report_.fall_reason = reason;
  }

  void record(int frame) {
    const auto qpos = motion_.qpos(frame);
    std::copy_n(data_->qpos, 7, qpos.begin());
    qpos[2] += floor_;
    Eigen::Map<Eigen::Vector4d> quaternion(qpos.data() + 3);
    quaternion.normalize();
    if (frame > 0) {
      align_sign(Eigen::Map<const Eigen::Vector4d>(motion_.qpos(frame - 1).data() + 3), quaternion);
    }
    for (const PhysicsJoint& joint : physics_.joints) {
      qpos[robot_.joints()[joint.joint].qpos_address] = data_->qpos[joint.dof + 1];
    }
  }

  // Repeats the last recorded frame after the simulation has diverged.
  void hold_from(int step) {
    const int first = (step + steps_per_frame_ - 1) / steps_per_frame_;
    for (int frame = std::max(1, first); frame < motion_.frame_count(); ++frame) {
      std::ranges::copy(motion_.qpos(frame - 1), motion_.qpos(frame).begin());
    }
  }

  void finish() {
    const int frames = report_.fell ? report_.fall_frame : report_.frames;
    set_errors(clip_, motion_, frames, report_);
    if (report_.knows_torque_limits && !torque_ratios_.empty()) {
      const auto at = std::ranges::count_if(torque_ratios_, [](double r) { return r > kAtLimit; });
      report_.torque_limit_pct =
          100.0 * static_cast<double>(at) / static_cast<double>(torque_ratios_.size());
      report_.torque_p99_ratio = percentile(torque_ratios_, 99.0);
    }
    if (slip_count_ > 0) report_.slip_cm_s = 100.0 * slip_ / static_cast<double>(slip_count_);
  }

  const RobotClip& clip_;
  const Robot& robot_;
  PhysicsModel physics_;
  MujocoData data_;
  int steps_per_frame_;
  double floor_, size_;
  ReferenceTrack track_;
  WholeBodyController controller_;
  RobotClip motion_;
  SimulationReport report_;
  std::size_t sole_count_ = 0;
  std::vector<double> torque_ratios_;  // One per step: largest ratio of a torque to its limit.
  std::vector<Vector3d> last_points_;
  double slip_ = 0.0;
  std::size_t slip_count_ = 0;
};

}  // namespace

Result<Simulation> simulate(const RobotClip& reference, const SimulateOptions& options) {
  if (reference.frame_count() < 3) {
    return input_failure({}, "a simulation needs at least three frames");
  }
  const double frame_time = 1.0 / reference.rate().fps();
  const int steps = std::max(1, static_cast<int>(std::ceil(frame_time / kLongestStep)));
  RETARGET_TRY_ASSIGN(PhysicsModel physics,
                      make_physics_model(reference.robot(), frame_time / steps));
  const double floor = standing_floor(reference);
  return Simulator(reference, std::move(physics), steps, floor).run(options);
}

namespace {

std::string row(const char* label, const std::string& text) {
  return fmt::format("{:<22}{}\n", label, text);
}

std::string row(const char* label, const MeanAndP95& value, const char* unit) {
  return row(label, fmt::format("{:.2f} {} (p95 {:.2f})", value.mean, unit, value.p95));
}

nlohmann::ordered_json to_json(const MeanAndP95& value) {
  return {{"mean", value.mean}, {"p95", value.p95}};
}

}  // namespace

std::string simulation_text(const SimulationReport& report) {
  std::string text = row("robot", printable(report.robot));
  text += row("time", fmt::format("{} frames at {} fps, steps of {:.3f} ms", report.frames,
                                  fmt::format("{:g}", report.fps), 1000.0 * report.time_step));
  text += row("fall", report.fell ? fmt::format("at {:.2f} s, frame {} ({})", report.fall_time_s,
                                                report.fall_frame, report.fall_reason)
                                  : std::string("none"));
  text += row("joint error", report.joint_deg, "deg");
  text += row("root position error", report.root_cm, "cm");
  text += row("root rotation error", report.root_deg, "deg");
  text += row("body position error", report.body_cm, "cm");
  if (report.knows_torque_limits) {
    text += row("torque at limit", fmt::format("{:.2f} % of the time", report.torque_limit_pct));
    text += row("torque p99", fmt::format("{:.2f} of the limit", report.torque_p99_ratio));
  }
  text += row("foot slip", fmt::format("{:.2f} cm/s", report.slip_cm_s));
  if (report.unsolved_steps > 0)
    text += row("unsolved steps", std::to_string(report.unsolved_steps));
  return text;
}

std::string simulation_json(const SimulationReport& report) {
  nlohmann::ordered_json json = {{"robot", report.robot},
                                 {"frames", report.frames},
                                 {"fps", report.fps},
                                 {"time_step", report.time_step},
                                 {"fell", report.fell}};
  json["fall_frame"] = report.fell ? nlohmann::ordered_json(report.fall_frame) : nullptr;
  json["fall_time_s"] = report.fell ? nlohmann::ordered_json(report.fall_time_s) : nullptr;
  json["fall_reason"] = report.fell ? nlohmann::ordered_json(report.fall_reason) : nullptr;
  json["joint_error_deg"] = to_json(report.joint_deg);
  json["root_error_cm"] = to_json(report.root_cm);
  json["root_error_deg"] = to_json(report.root_deg);
  json["body_error_cm"] = to_json(report.body_cm);
  const auto if_known = [&](double value) {
    return report.knows_torque_limits ? nlohmann::ordered_json(value) : nullptr;
  };
  json["torque_limit_pct"] = if_known(report.torque_limit_pct);
  json["torque_p99_ratio"] = if_known(report.torque_p99_ratio);
  json["slip_cm_s"] = report.slip_cm_s;
  json["unsolved_steps"] = report.unsolved_steps;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace retarget
