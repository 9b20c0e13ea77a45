#include "app/plan/scale_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "base/math/uniform_spline.h"
#include "base/option_name.h"
#include "base/try.h"
#include "motion/time_warp.h"
#include "retarget/option_table.h"
#include "retarget/text.h"
#include "scene/scene_world.h"
#include "solve/dynamics/motion_dynamics.h"

namespace retarget {
namespace {

constexpr double kKnotTime = 0.1;  // Seconds.
constexpr double kAim = 0.95;      // Share of a limit that a slowed stretch may use.
constexpr double kEase = 0.2;      // Change of the pace from knot to knot at most.
constexpr int kMaxRounds = 5;      // Solves.
constexpr double kStep = 1e-4;     // Coefficients are multiples of this.
constexpr double kMaxPace = 1.0 / kLeastTimeScale;
// A place that is slowed by this factor and hardly moves slower is a jump, which stays.
constexpr double kTried = 1.4, kNoHelp = 0.75;

// How far a step between two frames is beyond a limit.
struct Excess {
  double ratio = 1.0;   // Of the value to the limit; 1 or less: within it.
  double slower = 1.0;  // Seconds per second that bring it to kAim.
  std::string cause;
};

// The fastest that a joint may move in a solved motion, rad/s or m/s.
double joint_speed_limit(const Plan& plan, int joint) {
  const Robot& robot = *plan.robot.robot;
  double limit = robot.speed_limit(joint);
  const bool is_hinge =
      robot.joints()[static_cast<std::size_t>(joint)].type == RobotJoint::Type::kHinge;
  if (plan.options.solve.method == Method::kFit && is_hinge) {
    limit = std::min({limit, plan.fit.max_joint_speed, plan.fit.max_joint_step * plan.rate.fps()});
  }
  return limit;
}

// By step: exact speeds of the spline between frames.
void find_fast_joints(const Plan& plan, const RobotClip& clip, std::vector<Excess>& steps) {
  const Robot& robot = clip.robot();
  const double fps = clip.rate().fps();
  std::vector<double> column(static_cast<std::size_t>(clip.frame_count()));
  for (const int joint : robot.output_joints()) {
    const RobotJoint& of = robot.joints()[static_cast<std::size_t>(joint)];
    const double limit = joint_speed_limit(plan, joint);
    if (!std::isfinite(limit)) continue;
    for (int t = 0; t < clip.frame_count(); ++t) {
      column[static_cast<std::size_t>(t)] = clip.qpos(t)[static_cast<std::size_t>(of.qpos_address)];
    }
    const UniformSpline spline(column);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const UniformSpline::Range speeds = spline.velocities(static_cast<int>(i));
      const double ratio =
          fps * std::max(std::abs(speeds.least.value), std::abs(speeds.greatest.value)) / limit;
      if (ratio > steps[i].ratio) steps[i] = {ratio, ratio / kAim, of.name + " speed"};
    }
  }
}

// The largest torque ratio of every step, and its link; only where contacts can supply the forces.
std::vector<std::pair<double, int>> torque_ratios(const RobotClip& clip, const SceneWorld* scene) {
  const MotionDynamics dynamics = analyse_dynamics(clip, scene);
  std::vector<std::pair<double, int>> ratios(
      static_cast<std::size_t>(std::max(0, clip.frame_count() - 1)), {0.0, -1});
  for (std::size_t i = 0; i < dynamics.samples.size(); ++i) {
    const DynamicsSample& sample = dynamics.samples[i];
    auto& largest = ratios[static_cast<std::size_t>(dynamics.frame_of(i))];
    const bool counts = sample.supported && !sample.is_bad() && sample.torque_link > 0;
    if (counts && sample.torque_ratio > largest.first) {
      largest = {sample.torque_ratio, sample.torque_link};
    }
  }
  return ratios;
}

RobotClip at_half_speed(const RobotClip& clip) {
  FrameRate rate = clip.rate();
  rate.seconds *= 2;
  RobotClip slow(clip.shared_robot(), rate, clip.frame_count());
  for (int t = 0; t < clip.frame_count(); ++t)
    std::ranges::copy(clip.qpos(t), slow.qpos(t).begin());
  return slow;
}

// A torque has a part that rests and one that grows with the square of the speed. Half the speed
// separates the two.
void find_torques(const Plan& plan, const Motion& motion, std::vector<Excess>& steps) {
  if (!plan.fit.dynamics || plan.options.solve.method != Method::kFit) return;
  // A scene moves at its own speed.
  if (motion.scene) return;
  const auto now = torque_ratios(motion.clip, nullptr);
  const auto over = [](const auto& entry) { return entry.first > 1.0; };
  if (std::ranges::none_of(now, over)) return;
  const auto slow = torque_ratios(at_half_speed(motion.clip), nullptr);
  const Robot& robot = motion.clip.robot();
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto& [ratio, link] = now[i];
    if (!over(now[i]) || ratio <= steps[i].ratio) continue;
    const double moving = (ratio - slow[i].first) / 0.75, resting = ratio - moving;
    const int joint = robot.tree().links()[static_cast<std::size_t>(link)].joint;
    const double slower =
        moving > 0.0 && resting < kAim ? std::sqrt(moving / (kAim - resting)) : kMaxPace;
    steps[i] = {ratio, std::clamp(slower, 1.01, kMaxPace),
                robot.joints()[static_cast<std::size_t>(joint)].name + " torque"};
  }
}

// The pace that a place of the source needs, for the time between two knots.
struct PlaceNeed {
  double pace = 1.0;
  double first_ratio = 0.0;  // Before it was slowed.
  std::string cause;
  bool is_jump = false;  // Slowing does not help.
};

class TimePlanner {
 public:
  TimePlanner(const Plan& plan, double duration)
      : duration_(duration),
        rate_(plan.rate),
        needs_(static_cast<std::size_t>(std::max(1.0, std::ceil(duration / kKnotTime)))) {}

  // Takes what a solved motion exceeds. Returns whether the pace changed.
  bool take(const std::vector<Excess>& steps) {
    const TimeWarp warp(scale_, duration_);
    bool changed = false;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (steps[i].ratio <= 1.0) continue;
      const double from = warp.source_time(rate_.time_of(static_cast<std::int64_t>(i)));
      const double to = warp.source_time(rate_.time_of(static_cast<std::int64_t>(i) + 1));
      for (std::size_t knot = place(from); knot <= place(to); ++knot) {
        changed |= raise(needs_[knot], steps[i], warp.pace(0.5 * (from + to)));
      }
    }
    if (changed) set_pace();
    return changed;
  }

  // The decision; nothing if no place needs anything.
  [[nodiscard]] std::optional<TimeScale> decision() {
    find_stretches();
    if (scale_.stretches.empty()) scale_.pace.clear();
    if (scale_.stretches.empty() && scale_.left.empty()) return std::nullopt;
    return scale_;
  }

  [[nodiscard]] const TimeScale& scale() const { return scale_; }

 private:
  [[nodiscard]] std::size_t place(double source) const {
    return std::min(static_cast<std::size_t>(std::max(0.0, source) / kKnotTime), needs_.size() - 1);
  }

  static bool raise(PlaceNeed& need, const Excess& excess, double pace) {
    if (need.is_jump) return false;
    if (need.first_ratio == 0.0) {
      need.first_ratio = excess.ratio;
      need.cause = excess.cause;
    }
    if (pace > kTried && excess.ratio > kNoHelp * need.first_ratio) {
      need.is_jump = true;
      need.pace = 1.0;
      return true;
    }
    const double wanted = std::min(kMaxPace, pace * excess.slower);
    if (wanted <= need.pace) return false;
    need.pace = wanted;
    return true;
  }

  // A piece depends on four coefficients, so all of them must be as large as it needs.
  void set_pace() {
    std::vector<double>& pace = scale_.pace;
    pace.assign(needs_.size() + 3, 1.0);
    for (std::size_t i = 0; i < needs_.size(); ++i) {
      const double wanted = std::min(kMaxPace, std::ceil(needs_[i].pace / kStep) * kStep);
      for (std::size_t k = i; k < i + 4; ++k) pace[k] = std::max(pace[k], wanted);
    }
    for (std::size_t k = 1; k < pace.size(); ++k) pace[k] = std::max(pace[k], pace[k - 1] - kEase);
    for (std::size_t k = pace.size() - 1; k-- > 0;) {
      pace[k] = std::max(pace[k], pace[k + 1] - kEase);
    }
    for (double& each : pace) each = std::max(1.0, std::round(each / kStep) * kStep);
  }

  void find_stretches() {
    scale_.knot_time = kKnotTime;
    scale_.stretches.clear();
    scale_.left.clear();
    const TimeWarp warp(scale_, duration_);
    scale_.longer = warp.duration() - duration_;
    bool inside = false;
    double strongest = 0.0;
    for (std::size_t i = 0; i < needs_.size(); ++i) {
      const double begin = static_cast<double>(i) * kKnotTime;
      const double end = std::min(duration_, begin + kKnotTime);
      const double pace =
          std::max({warp.pace(begin), warp.pace(0.5 * (begin + end)), warp.pace(end)});
      if (pace <= 1.0 + kStep) {
        inside = false;
      } else {
        if (!inside) {
          scale_.stretches.push_back({begin, end, 1.0, {}});
          strongest = 0.0;
        }
        inside = true;
        SlowedStretch& stretch = scale_.stretches.back();
        stretch.end = end;
        stretch.factor = std::min(stretch.factor, 1.0 / pace);
        if (!needs_[i].is_jump && needs_[i].first_ratio > strongest) {
          strongest = needs_[i].first_ratio;
          stretch.cause = needs_[i].cause;
        }
      }
      if (needs_[i].is_jump) add_left(i, begin, end);
    }
  }

  void add_left(std::size_t i, double begin, double end) {
    const bool continues = i > 0 && needs_[i - 1].is_jump;
    if (!continues) scale_.left.push_back({begin, end, 1.0, {}});
    SlowedStretch& left = scale_.left.back();
    left.end = end;
    const double factor = 1.0 / needs_[i].first_ratio;
    if (left.cause.empty() || factor < left.factor) {
      left.factor = factor;
      left.cause = needs_[i].cause;
    }
  }

  double duration_;
  FrameRate rate_;  // Of the motion.
  std::vector<PlaceNeed> needs_;
  TimeScale scale_;
};

std::string stretch_text(const SlowedStretch& stretch) {
  const std::string cause = stretch.cause.empty() ? "" : " (" + stretch.cause + ")";
  return fmt::format("{:.1f}-{:.1f} s to {:.2f}{}", stretch.begin, stretch.end, stretch.factor,
                     cause);
}

double part_duration(const Plan& plan) {
  const int frames = plan.part.end - plan.part.begin;
  return frames < 2 ? 0.0 : plan.clip->rate().time_of(frames - 1);
}

}  // namespace

TimeScale constant_time_scale(double factor, double duration) {
  TimeScale scale;
  scale.knot_time = kKnotTime;
  const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(duration / kKnotTime)));
  scale.pace.assign(pieces + 3, 1.0 / factor);
  scale.stretches = {{0.0, duration, factor, {}}};
  scale.longer = duration / factor - duration;
  return scale;
}

Result<void> set_time_scale(Plan& plan) {
  const std::string& given = plan.options.solve.time_scale;
  if (given.empty()) return {};
  TRY_ASSIGN(const auto factor, time_scale_from_text(given));
  const double duration = part_duration(plan);
  if (!factor || *factor == 1.0 || duration <= 0.0) return {};
  plan.time_scale = constant_time_scale(*factor, duration);
  for (SummaryLine& line : time_scale_lines(*plan.time_scale)) {
    plan.clip_notes.push_back(std::move(line));
  }
  return {};
}

std::vector<SummaryLine> time_scale_lines(const TimeScale& scale) {
  constexpr std::size_t kNamed = 4;
  std::vector<SummaryLine> lines;
  const auto listed = [](const std::vector<SlowedStretch>& stretches) {
    std::vector<std::string> texts;
    for (const SlowedStretch& stretch : stretches) texts.push_back(stretch_text(stretch));
    const std::size_t more = texts.size() > kNamed ? texts.size() - kNamed : 0;
    texts.resize(texts.size() - more);
    std::string text = fmt::format("{}", fmt::join(texts, ", "));
    if (more > 0) text += fmt::format(", and {} more", more);
    return text;
  };
  if (!scale.stretches.empty()) {
    lines.push_back(
        {"slowed", fmt::format("{}; {:.2f} s longer", listed(scale.stretches), scale.longer)});
  }
  if (!scale.left.empty()) {
    lines.push_back(
        {"not slowed", "beyond limits, but slower movement does not help: " + listed(scale.left)});
  }
  return lines;
}

Result<Plan> decide_time_scale(Plan plan, const SolveControl& control) {
  const std::string& given = plan.options.solve.time_scale;
  if (given != "auto" || plan.time_scale || !plan.clip) return plan;
  const double duration = part_duration(plan);
  if (duration <= 0.0) return plan;
  SolveControl quiet = control;
  quiet.frame_solved = {};
  TimePlanner planner(plan, duration);
  for (int round = 0; round < kMaxRounds; ++round) {
    Plan trial = plan;
    if (!planner.scale().pace.empty()) trial.time_scale = planner.scale();
    TRY_ASSIGN(const Motion motion, solve_in_time(std::move(trial), quiet, false));
    if (motion.clip.frame_count() < 3) break;
    std::vector<Excess> steps(static_cast<std::size_t>(motion.clip.frame_count() - 1));
    find_fast_joints(plan, motion.clip, steps);
    find_torques(plan, motion, steps);
    if (!planner.take(steps)) break;
  }
  plan.time_scale = planner.decision();
  if (plan.time_scale) {
    for (SummaryLine& line : time_scale_lines(*plan.time_scale)) {
      plan.clip_notes.push_back(std::move(line));
    }
  }
  return plan;
}

}  // namespace retarget
