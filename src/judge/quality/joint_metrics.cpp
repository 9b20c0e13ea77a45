#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "judge/quality/body_metrics.h"
#include "judge/quality/report_parts.h"
#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "retarget/pose.h"
#include "retarget/report.h"
#include "retarget/root_pose.h"
#include "retarget/spline.h"
#include "retarget/statistics.h"
#include "retarget/trigonometry.h"
#include "solve/dynamics/inertias.h"

namespace retarget {
namespace {

// Tolerance for files whose numbers have six digits, rad or m.
constexpr double kTolerance = 1e-6;
constexpr double kMilliradian = 1e-3;
constexpr double kJump = 0.5;                     // Step of a joint, rad or m.
constexpr double kFast = 3.0 * std::numbers::pi;  // Speed of a joint, rad/s or m/s.

double excess_of(const LimitSet& limits, int joint, double position) {
  return std::max(limits.lower[joint] - position, position - limits.upper[joint]);
}

// @param faults  receives the joints beyond their limits; may be null.
LimitSetResult compare_with(const LimitSet& limits, const RobotClip& clip, FaultList* faults) {
  const Robot& robot = clip.robot();
  LimitSetResult result;
  result.name = limits.name;
  int frames = 0, frames_1mrad = 0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    bool beyond = false, beyond_1mrad = false;
    for (const int j : robot.output_joints()) {
      const RobotJoint& joint = robot.joints()[j];
      const double excess = excess_of(limits, j, clip.qpos(frame)[joint.qpos_address]);
      if (excess <= 0.0) continue;
      if (excess > result.worst_excess) {
        result.worst_excess = excess;
        result.joint = joint.name;
        result.frame = frame;
      }
      if (excess <= kTolerance) continue;
      beyond = true;
      beyond_1mrad = beyond_1mrad || excess > kMilliradian;
      if (faults != nullptr) faults->add(joint.name, frame, excess);
    }
    if (beyond) ++frames;
    if (beyond_1mrad) ++frames_1mrad;
  }
  result.frames_pct = percent(frames, clip.frame_count());
  result.frames_1mrad_pct = percent(frames_1mrad, clip.frame_count());
  return result;
}

void measure_limits(const ReportBuilder& draft, const LimitSet& limits) {
  FaultList faults("limit_pct", "rad");
  const LimitSetResult chosen = compare_with(limits, draft.clip, &faults);
  draft.set("limit_pct", chosen.frames_pct);
  draft.set("limit_max_rad", chosen.worst_excess);
  faults.move_to(draft.report, draft.options.faults_per_metric);

  auto& sets = draft.report.limit_sets;
  sets.push_back(chosen);
  const Robot& robot = draft.clip.robot();
  const auto add = [&](const LimitSet& set) {
    if (std::ranges::find(sets, set.name, &LimitSetResult::name) == sets.end()) {
      sets.push_back(compare_with(set, draft.clip, nullptr));
    }
  };
  for (const LimitSet& set : robot.profile().limit_sets) add(set);
  add(robot.model_limits());
}

// By output joint, rad/s or m/s.
std::vector<double> speed_limits(const ReportBuilder& draft) {
  const Robot& robot = draft.clip.robot();
  const auto& given = robot.profile().speed_limits;
  draft.report.assumed_speed_limit = robot.profile().default_speed_limit;
  std::vector<double> limits;
  for (const int j : robot.output_joints()) {
    const bool is_given = given.contains(robot.joints()[j].name);
    ++(is_given ? draft.report.speed_limits_given : draft.report.speed_limits_assumed);
    limits.push_back(robot.speed_limit(j));
  }
  return limits;
}

void measure_speeds(const ReportBuilder& draft) {
  const RobotClip& clip = draft.clip;
  const Robot& robot = clip.robot();
  const std::vector<double> limits = speed_limits(draft);
  const double fps = clip.rate().fps();
  const int steps = clip.frame_count() - 1;
  if (steps < 1) return;
  FaultList over_limit("speed_limit_pct", "rad/s"), jumping("jumps", "rad");
  int frames_over = 0, frames_fast = 0, jumps = 0, frames_jumping = 0;
  double max = 0.0, ratio = 0.0;
  for (int frame = 0; frame < steps; ++frame) {
    bool over = false, fast = false, jumped = false;
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const RobotJoint& joint = robot.joints()[robot.output_joints()[i]];
      const double step =
          std::abs(clip.qpos(frame + 1)[joint.qpos_address] - clip.qpos(frame)[joint.qpos_address]);
      max = std::max(max, step);
      ratio = std::max(ratio, step * fps / limits[i]);
      fast = fast || step * fps > kFast;
      if (step > limits[i] / fps + kTolerance) {
        over = true;
        over_limit.add(joint.name, frame, step * fps);
      }
      if (step > kJump) {
        jumped = true;
        ++jumps;
        jumping.add(joint.name, frame, step);
      }
    }
    if (over) ++frames_over;
    if (fast) ++frames_fast;
    if (jumped) ++frames_jumping;
  }
  draft.set("speed_limit_pct", percent(frames_over, steps));
  draft.set("speed_limit_max_ratio", ratio);
  draft.set("peak_speed", max * fps);
  draft.set("fast_3pi_pct", percent(frames_fast, steps));
  draft.set("jumps", jumps);
  draft.set("jump_frames", frames_jumping);
  draft.set("max_step_rad", max);
  over_limit.move_to(draft.report, draft.options.faults_per_metric);
  jumping.move_to(draft.report, draft.options.faults_per_metric);
}

void measure_accelerations(const ReportBuilder& draft) {
  const RobotClip& clip = draft.clip;
  const Robot& robot = clip.robot();
  const int count = clip.frame_count() - 2;
  if (count < 1 || robot.output_joints().empty()) return;
  const double fps = clip.rate().fps();
  double squares = 0.0;
  std::vector<double> largest;
  largest.reserve(count);
  for (int frame = 0; frame < count; ++frame) {
    double of_frame = 0.0;
    for (const int j : robot.output_joints()) {
      const int at = robot.joints()[j].qpos_address;
      // The difference of two steps has the same rounding as numpy.diff.
      const double first = clip.qpos(frame + 1)[at] - clip.qpos(frame)[at];
      const double second = clip.qpos(frame + 2)[at] - clip.qpos(frame + 1)[at];
      const double acceleration = (second - first) * fps * fps;
      squares += acceleration * acceleration;
      of_frame = std::max(of_frame, std::abs(acceleration));
    }
    largest.push_back(of_frame);
  }
  const auto terms = static_cast<double>(robot.output_joints().size()) * count;
  draft.set("acc_rms", std::sqrt(squares / terms));
  draft.set("acc_p99", percentile(std::move(largest), 99.0));
}

void measure_root_jerk(const ReportBuilder& draft) {
  const RobotClip& clip = draft.clip;
  const int stride = difference_stride(clip.rate().fps());
  const int count = clip.frame_count() - 3 * stride;
  if (count < 1) return;
  const double fps = clip.rate().fps() / stride;
  const auto root = [&clip](int frame) { return root_pose(clip.qpos(frame)).translation; };
  std::vector<double> jerks;
  jerks.reserve(count);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d third =
        root(i + 3 * stride) - 3.0 * root(i + 2 * stride) + 3.0 * root(i + stride) - root(i);
    jerks.push_back(third.norm() * fps * fps * fps);
  }
  draft.set("root_jerk_mean", mean(jerks));
  draft.set("root_jerk_p99", percentile(std::move(jerks), 99.0));
}

// Counts physically impossible steps of the root, such as a frame from another pose or a sudden
// reversal of the facing.
void measure_root_jumps(const ReportBuilder& draft) {
  constexpr double kMaxRootSpeed = 10.0;  // m/s
  constexpr double kMaxTurnRate = 20.0;   // rad/s
  const RobotClip& clip = draft.clip;
  const double fps = clip.rate().fps();
  FaultList moving("root_jumps", "m/s"), turning("root_jumps", "rad/s");
  int jumps = 0;
  for (int frame = 0; frame + 1 < clip.frame_count(); ++frame) {
    const Pose before = root_pose(clip.qpos(frame)), now = root_pose(clip.qpos(frame + 1));
    const double speed = (now.translation - before.translation).norm() * fps;
    const Eigen::Quaterniond step = before.rotation.conjugate() * now.rotation;
    const double turn = 2.0 * portable::atan2(step.vec().norm(), std::abs(step.w())) * fps;
    if (speed <= kMaxRootSpeed && turn <= kMaxTurnRate) continue;
    ++jumps;
    if (speed > kMaxRootSpeed) moving.add("root", frame, speed);
    if (turn > kMaxTurnRate) turning.add("root", frame, turn);
  }
  draft.set("root_jumps", jumps);
  moving.move_to(draft.report, draft.options.faults_per_metric);
  turning.move_to(draft.report, draft.options.faults_per_metric);
}

}  // namespace

void measure_joints(const ReportBuilder& draft, const LimitSet& limits) {
  measure_limits(draft, limits);
  measure_speeds(draft);
  measure_accelerations(draft);
  measure_root_jerk(draft);
  measure_root_jumps(draft);
}

namespace {

using Eigen::Vector3d;

// Lengths of the accelerations of the cubic spline through the points, by frame, m/s^2. The
// acceleration is linear between frames, so its maximum is at a frame.
std::vector<double> accelerations_of(std::span<const Vector3d> points, double fps) {
  const std::vector<Vector3d> steps = steps_between(points);
  const std::vector<Vector3d> velocities = spline_velocities(steps);
  std::vector<double> lengths;
  lengths.reserve(points.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Vector3d square = 3.0 * steps[i] - 2.0 * velocities[i] - velocities[i + 1];
    lengths.push_back(2.0 * square.norm() * fps * fps);
  }
  const Vector3d last = 2.0 * velocities.back() + velocities[steps.size() - 1] - 3.0 * steps.back();
  lengths.push_back(2.0 * last.norm() * fps * fps);
  return lengths;
}

std::vector<Vector3d> centres_of_mass(const RobotClip& clip, const Inertias& inertias) {
  std::vector<Vector3d> centres;
  centres.reserve(static_cast<std::size_t>(clip.frame_count()));
  TreeState state(clip.robot().tree());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    state.update(clip.qpos(frame));
    Vector3d moment = Vector3d::Zero();
    for (std::size_t i = 0; i < inertias.links.size(); ++i) {
      moment += inertias.links[i].mass * (state.world_from_link[i] * inertias.links[i].com);
    }
    centres.emplace_back(moment / inertias.mass);
  }
  return centres;
}

// Names the frames with accelerations that no motion of a person has; like the bound of the default
// gate, they are in proportion to the legs.
void name_jolts(const std::vector<double>& accelerations, const ReportBuilder& draft) {
  constexpr double kLarge = 40.0, kUsualLeg = 0.632;  // m/s^2, metres.
  const double large = kLarge * draft.report.leg.value_or(kUsualLeg) / kUsualLeg;
  FaultList jolts("root_acc_max", "m/s^2");
  for (std::size_t frame = 0; frame < accelerations.size(); ++frame) {
    if (accelerations[frame] > large) {
      jolts.add("root", static_cast<int>(frame), accelerations[frame]);
    }
  }
  jolts.move_to(draft.report, draft.options.faults_per_metric);
}

}  // namespace

void measure_body_accelerations(const ReportBuilder& draft) {
  constexpr int kMinFrames = 3;
  const RobotClip& clip = draft.clip;
  if (clip.frame_count() < kMinFrames) return;
  const double fps = clip.rate().fps();
  std::vector<Vector3d> root;
  root.reserve(static_cast<std::size_t>(clip.frame_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    root.emplace_back(clip.qpos(frame)[0], clip.qpos(frame)[1], clip.qpos(frame)[2]);
  }
  std::vector<double> of_root = accelerations_of(root, fps);
  draft.set("root_acc_max", *std::ranges::max_element(of_root));
  name_jolts(of_root, draft);
  draft.set("root_acc_p99", percentile(std::move(of_root), 99.0));
  const Inertias inertias = make_inertias(clip.robot());
  if (inertias.mass <= 0.0) return;
  std::vector<double> of_mass = accelerations_of(centres_of_mass(clip, inertias), fps);
  double squares = 0.0;
  for (const double acceleration : of_mass) squares += acceleration * acceleration;
  draft.set("com_acc_rms", std::sqrt(squares / static_cast<double>(of_mass.size())));
  draft.set("com_acc_p99", percentile(std::move(of_mass), 99.0));
}

}  // namespace retarget
