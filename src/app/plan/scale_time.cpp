#include "app/plan/scale_time.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "app/plan/limb_errors.h"
#include "app/plan/time_planner.h"
#include "base/math/uniform_spline.h"
#include "base/try.h"
#include "retarget/option_table.h"
#include "retarget/robot.h"
#include "solve/dynamics/motion_dynamics.h"

namespace retarget {
namespace {

constexpr double kKnotTime = 0.1;  // Seconds.
constexpr int kSearchRate = 30;    // Most frames per second of the solves of a search.
constexpr double kAim = 0.95;      // Share of a limit that a slowed interval uses.
constexpr int kMaxRounds = 5;      // Maximum number of slowed solves.
constexpr double kMostSlower = 1.0 / kLeastTimeScale;
// A limb that is this much farther from the human than without speed limits is distorted, degrees.
// In intervals that are already slower, the pace rises until little of the excess remains.
constexpr double kDistorted = 3.0, kLittle = 1.0;
// Limits act at this distance in time, seconds.
constexpr double kActsWithin = 0.1;

// Excess of a step between two frames over a speed limit.
struct FastStep {
  double ratio = 0.0;  // Ratio of the speed to the limit.
  std::string cause;
};

// Speed limit of a joint in a solved motion, rad/s or m/s.
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

// By step: speed ratios from the exact speeds of the spline between frames.
// @param limit_of  speed limit of a joint
template <typename Limit>
std::vector<FastStep> fast_steps(const RobotClip& clip, const Limit& limit_of) {
  const Robot& robot = clip.robot();
  const double fps = clip.rate().fps();
  std::vector<FastStep> steps(static_cast<std::size_t>(clip.frame_count() - 1));
  std::vector<double> column(static_cast<std::size_t>(clip.frame_count()));
  for (const int joint : robot.output_joints()) {
    const RobotJoint& of = robot.joints()[static_cast<std::size_t>(joint)];
    const double limit = limit_of(joint);
    if (!std::isfinite(limit)) continue;
    for (int t = 0; t < clip.frame_count(); ++t) {
      column[static_cast<std::size_t>(t)] = clip.qpos(t)[static_cast<std::size_t>(of.qpos_address)];
    }
    const UniformSpline spline(column);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const UniformSpline::Range speeds = spline.velocities(static_cast<int>(i));
      const double ratio =
          fps * std::max(std::abs(speeds.least.value), std::abs(speeds.greatest.value)) / limit;
      if (ratio > steps[i].ratio) steps[i] = {ratio, of.name + " speed"};
    }
  }
  return steps;
}

// By step: the fastest step near it.
std::vector<FastStep> fastest_near(const std::vector<FastStep>& steps, double fps) {
  const auto reach = static_cast<std::size_t>(std::max(1.0, std::round(kActsWithin * fps)));
  std::vector<FastStep> near;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::size_t begin = i < reach ? 0 : i - reach,
                      end = std::min(steps.size(), i + reach + 1);
    near.push_back(*std::ranges::max_element(steps.begin() + static_cast<std::ptrdiff_t>(begin),
                                             steps.begin() + static_cast<std::ptrdiff_t>(end), {},
                                             &FastStep::ratio));
  }
  return near;
}

// The largest torque ratio of every step, and its link; only where contacts can supply the forces.
std::vector<std::pair<double, int>> torque_ratios(const RobotClip& clip) {
  const MotionDynamics dynamics = analyse_dynamics(clip, nullptr);
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

// Torques are included if the dynamics stage runs. A scene would have to be slowed down as well.
bool takes_torques(const Plan& plan, const Motion& motion) {
  return plan.fit.dynamics && plan.options.solve.method == Method::kFit && !motion.scene;
}

// A torque has a static part and a part that grows with the square of the speed. Inverse dynamics
// at half the speed separates the two.
void find_torques(const Plan& plan, const Motion& motion, std::vector<StepNeed>& needs) {
  if (!takes_torques(plan, motion)) return;
  const auto now = torque_ratios(motion.clip);
  const auto over = [](const auto& entry) { return entry.first > 1.0; };
  if (std::ranges::none_of(now, over)) return;
  const auto slow = torque_ratios(at_half_speed(motion.clip));
  const Robot& robot = motion.clip.robot();
  for (std::size_t i = 0; i < now.size(); ++i) {
    const auto& [ratio, link] = now[i];
    if (!over(now[i])) continue;
    const double moving = (ratio - slow[i].first) / 0.75, resting = ratio - moving;
    const int joint = robot.tree().links()[static_cast<std::size_t>(link)].joint;
    // Slowing cannot reduce a static torque above the limit.
    if (moving <= 0.0 || resting >= kAim) continue;
    needs.push_back({static_cast<int>(i), StepNeed::kTorque, ratio - 1.0,
                     std::clamp(std::sqrt(moving / (kAim - resting)), 1.05, kMostSlower),
                     robot.joints()[static_cast<std::size_t>(joint)].name + " torque"});
  }
}

double part_duration(const Plan& plan) {
  const int frames = plan.part.end - plan.part.begin;
  return frames < 2 ? 0.0 : plan.clip->rate().time_of(frames - 1);
}

// Finds the time scale of a plan by solving it.
class TimeScaleSearch {
 public:
  TimeScaleSearch(const Plan& plan, const SolveControl& control, double duration)
      : plan_(plan), control_(control), planner_(duration, plan.rate) {
    control_.frame_solved = {};
    control_.fit_costs = false;
  }

  Result<std::optional<TimeScale>> run() {
    TRY_ASSIGN(Motion motion, solve_now(true));
    if (motion.clip.frame_count() < 3) return std::optional<TimeScale>();
    usual_ = limb_errors(motion);
    usual_excess_ = torque_excess(motion);
    TRY(solve_freely(motion));
    for (int round = 0; round < kMaxRounds && planner_.take(needs_of(motion)); ++round) {
      TRY_ASSIGN(motion, solve_now(true));
    }
    restore_intervals_without_gain(motion);
    return planner_.decision();
  }

 private:
  Result<Motion> solve_now(bool limit_speeds) const {
    Plan trial = plan_;
    if (!planner_.scale().pace.empty()) trial.time_scale = planner_.scale();
    return solve_in_time(std::move(trial), control_, limit_speeds);
  }

  [[nodiscard]] bool is_fit() const { return plan_.options.solve.method == Method::kFit; }

  // Limits act on joints that are faster than this share of them.
  static constexpr double kActs = 0.88;

  // Solves without speed limits if they act on the motion.
  Result<void> solve_freely(const Motion& usual) {
    if (!is_fit()) return {};
    const bool acts = std::ranges::any_of(fast_near(usual),
                                          [](const FastStep& step) { return step.ratio > kActs; });
    if (!acts) return {};
    TRY_ASSIGN(const Motion free, solve_now(false));
    free_ = limb_errors(free);
    fast_ = fastest_near(
        fast_steps(free.clip, [&](int joint) { return joint_speed_limit(plan_, joint); }),
        plan_.rate.fps());
    return {};
  }

  // By step: the speeds of a motion near it, relative to those from which the fit slows joints
  // down.
  [[nodiscard]] std::vector<FastStep> fast_near(const Motion& motion) const {
    return fastest_near(fast_steps(motion.clip, [&](int joint) { return soft_speed(joint); }),
                        plan_.rate.fps());
  }

  // The speed from which the fit slows a joint down.
  [[nodiscard]] double soft_speed(int joint) const {
    const double limit = joint_speed_limit(plan_, joint);
    const bool is_hinge = plan_.robot.robot->joints()[static_cast<std::size_t>(joint)].type ==
                          RobotJoint::Type::kHinge;
    return is_hinge ? std::min(limit, plan_.fit.soft_joint_speed) : limit;
  }

  [[nodiscard]] std::vector<StepNeed> needs_of(const Motion& motion) const {
    std::vector<StepNeed> needs;
    if (is_fit()) {
      find_distortions(motion, needs);
    } else {
      const auto steps =
          fast_steps(motion.clip, [&](int joint) { return joint_speed_limit(plan_, joint); });
      for (std::size_t i = 0; i < steps.size(); ++i) {
        if (steps[i].ratio <= 1.0) continue;
        needs.push_back({static_cast<int>(i), StepNeed::kSpeed, steps[i].ratio - 1.0,
                         steps[i].ratio / kAim, steps[i].cause});
      }
    }
    find_torques(plan_, motion, needs);
    return needs;
  }

  // Steps that are too fast without limits, and in which limits turn a limb away from the human.
  void find_distortions(const Motion& motion, std::vector<StepNeed>& needs) const {
    constexpr double kStretched = 1.02, kLeastFirst = 1.15, kMostFirst = 1.5, kMore = 1.3;
    if (fast_.empty()) return;
    const std::vector<LimbErrors> errors = limb_errors(motion);
    const std::vector<FastStep> now = fast_near(motion);
    for (int i = 0; i + 1 < motion.clip.frame_count(); ++i) {
      if (now[static_cast<std::size_t>(i)].ratio <= kActs) continue;
      const double source = planner_.source_time(i);
      const std::size_t at = unslowed_frame(source, fast_.size());
      const double increase = largest_increase(free_[at], errors[static_cast<std::size_t>(i)]);
      const double pace = planner_.pace_at(source);
      const double accepted = pace > kStretched ? kLittle : kDistorted;
      if (fast_[at].ratio <= 1.0 || increase <= accepted) continue;
      const bool is_first = pace < kLeastFirst;
      needs.push_back({i, StepNeed::kSpeed, increase,
                       is_first ? std::clamp(fast_[at].ratio, kLeastFirst, kMostFirst) : kMore,
                       fast_[at].cause});
    }
  }

  [[nodiscard]] std::size_t unslowed_frame(double source, std::size_t count) const {
    return std::min(static_cast<std::size_t>(std::lround(source * plan_.rate.fps())), count - 1);
  }

  // By step: relative excess of the largest torque over its limit; empty if torques are not
  // considered.
  [[nodiscard]] std::vector<double> torque_excess(const Motion& motion) const {
    std::vector<double> excess;
    if (!takes_torques(plan_, motion)) return excess;
    for (const auto& [ratio, link] : torque_ratios(motion.clip)) {
      excess.push_back(std::max(0.0, ratio - 1.0));
    }
    return excess;
  }

  // Keeps a slowed interval only if the limbs are nearer to the human than without it, or if they
  // are as near and the torques are lower.
  void restore_intervals_without_gain(const Motion& motion) {
    constexpr double kGain = 0.3, kLoss = 0.2;  // Degrees.
    constexpr double kLighter = 0.5;            // Share of the torque beyond limits.
    const auto decided = planner_.decision();
    if (!decided) return;
    const std::vector<LimbErrors> errors = limb_errors(motion);
    const std::vector<double> excess = torque_excess(motion);
    for (const SlowedStretch& stretch : decided->stretches) {
      double before = 0.0, after = 0.0, time = 0.0, torque_before = 0.0, torque_after = 0.0;
      for (int i = 0; i + 1 < motion.clip.frame_count(); ++i) {
        const double from = planner_.source_time(i), to = planner_.source_time(i + 1);
        if (from < stretch.begin || from >= stretch.end) continue;
        before += (to - from) * mean_error(usual_[unslowed_frame(from, usual_.size())]);
        after += (to - from) * mean_error(errors[static_cast<std::size_t>(i)]);
        time += to - from;
        if (excess.empty()) continue;
        torque_before += (to - from) * usual_excess_[unslowed_frame(from, usual_excess_.size())];
        torque_after += (to - from) * excess[static_cast<std::size_t>(i)];
      }
      const bool is_torque = stretch.cause.ends_with("torque");
      const double gain = time > 0.0 ? (before - after) / time : 0.0;
      const bool is_lighter = torque_after < kLighter * torque_before;
      if (is_torque ? is_lighter && gain >= -kLoss : gain >= (is_fit() ? kGain : -kLoss)) continue;
      planner_.restore(stretch.begin, stretch.end - 0.5 * kKnotTime);
    }
  }

  const Plan& plan_;
  SolveControl control_;
  TimePlanner planner_;
  std::vector<LimbErrors> usual_, free_;  // By frame, at the usual speed; with and without limits.
  std::vector<double> usual_excess_;      // One per step, of torques.
  std::vector<FastStep> fast_;            // One per step, without limits; empty: limits do not act.
};

std::string stretch_text(const SlowedStretch& stretch) {
  std::string text = fmt::format("{:.1f}-{:.1f} s", stretch.begin, stretch.end);
  if (stretch.factor < 1.0) text += fmt::format(" to {:.2f}", stretch.factor);
  return stretch.cause.empty() ? text : text + " (" + stretch.cause + ")";
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
    lines.push_back({scale.stretches.empty() ? "slowed" : "",
                     "without effect, so unchanged: " + listed(scale.left)});
  }
  return lines;
}

Result<Plan> decide_time_scale(Plan plan, const SolveControl& control) {
  const std::string& given = plan.options.solve.time_scale;
  if (given != "auto" || plan.time_scale || !plan.clip) return plan;
  const double duration = part_duration(plan);
  if (duration <= 0.0) return plan;
  // The pace of a motion is the same in all of its formats. A lower rate than usual has a lower
  // limit on speeds (FitOptions::max_joint_step).
  Plan searched = plan;
  const auto& fps = plan.options.time.fps;
  searched.rate = fps ? frame_rate_from_fps(*fps) : plan.clip->rate();
  if (searched.rate.fps() > kSearchRate) searched.rate = {kSearchRate, 1};
  TRY_ASSIGN(plan.time_scale, TimeScaleSearch(searched, control, duration).run());
  if (plan.time_scale) {
    for (SummaryLine& line : time_scale_lines(*plan.time_scale)) {
      plan.clip_notes.push_back(std::move(line));
    }
  }
  return plan;
}

}  // namespace retarget
