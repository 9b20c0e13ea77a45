#include "retarget/live.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "live/session/frame_queue.h"
#include "live/session/motion_limiter.h"
#include "live/session/playout.h"
#include "live/session/sender_clock.h"
#include "live/session/window_times.h"
#include "retarget/live_table.h"
#include "retarget/online_solver.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Seconds that a frame may be overdue before it counts as missing.
constexpr double kPatience = 0.1;
constexpr double kTooFar = 1e5;  // Metres from the origin.

Result<std::unique_ptr<OnlineSolver>> make_solver(const Plan& plan, const LiveOptions& options) {
  RETARGET_TRY(check_live_options(options, plan.options.solve.method));
  if (!plan.clip || plan.clip->frame_count() == 0) {
    return usage_failure("a stream needs a plan with at least one frame of the performer");
  }
  OnlineOptions online;
  online.frame_time = frame_rate_from_fps(options.fps).frame_time();
  if (options.mode == LiveMode::kLag) online.lag_s = options.lag_s;
  online.floor = options.floor;
  online.hold_feet = options.hold_feet;
  RETARGET_TRY_ASSIGN(OnlineSolver solver, OnlineSolver::make(plan, online));
  return std::make_unique<OnlineSolver>(std::move(solver));
}

bool is_sound(const HumanPose& human) {
  return std::ranges::all_of(human, [](const Pose& pose) {
    return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
           pose.translation.cwiseAbs().maxCoeff() < kTooFar && pose.rotation.norm() > 1e-6;
  });
}

}  // namespace

class LiveSession::Impl {
 public:
  Impl(const Plan& plan, const LiveOptions& options, std::unique_ptr<OnlineSolver> solver)
      : options_(options),
        rate_(frame_rate_from_fps(options.fps)),
        solver_(std::move(solver)),
        playout_(rate_.frame_time(), options.delay_s),
        limiter_(*plan.robot.robot, plan.limits, plan.fit, options.limits, rate_.frame_time()),
        wanted_(plan.robot.robot->zero_configuration()),
        standing_(*plan.robot.robot, plan.limits),
        window_(solver_->window_frames()) {}

  void push(const HumanFrame& frame, double now);
  std::optional<RobotFrame> pull(double now);
  [[nodiscard]] std::optional<double> due() const;
  void skip_to(double now);
  void finish() { finished_ = true; }
  void reset();
  void recalibrate(std::unique_ptr<OnlineSolver> solver);

  [[nodiscard]] const LiveOptions& options() const { return options_; }
  [[nodiscard]] const LiveStatistics& statistics() const { return statistics_; }
  [[nodiscard]] LiveState state() const { return state_; }
  [[nodiscard]] const Robot& robot() const { return solver_->robot(); }

 private:
  bool begin();
  std::optional<RobotFrame> leave(const Playout::Slot& slot);
  bool feed(const HumanPose& human);
  bool hold(double seconds);
  void interrupt(double now);
  RobotFrame show(const Playout::Slot& slot, LiveState state);
  [[nodiscard]] bool has_window() const { return solver_->window_frames() > 0; }
  void limit(const Playout::Slot& slot, LiveState state);
  std::optional<RobotFrame> show_rest();
  void note(const Playout::Slot& slot);

  LiveOptions options_;
  FrameRate rate_;
  std::unique_ptr<OnlineSolver> solver_;  // Of the current body.
  SenderClock clock_;
  FrameQueue queue_;
  Playout playout_;
  MotionLimiter limiter_;
  LiveState state_ = LiveState::kWaiting;
  LiveStatistics statistics_;
  HumanPose human_;             // Human pose that was solved last.
  std::vector<double> wanted_;  // Target configuration of the robot.
  StandingPose standing_;
  bool has_human_ = false, finished_ = false;
  bool begun_ = false;
  bool absent_ = false;  // Frames have been missing for longer than kPatience.
  bool catches_up_ = false;
  double settled_ = -std::numeric_limits<double>::infinity();  // Last multi-start search.
  WindowTimes window_;
};

void LiveSession::Impl::push(const HumanFrame& frame, double now) {
  ++statistics_.received;
  if (!is_sound(frame.world_from_bone) || !is_live_time(now)) {
    ++statistics_.bad;
    return;
  }
  const bool by_sender = options_.clock == LiveClock::kSender && std::isfinite(frame.time);
  const double used = playout_.time();
  const int set_back = clock_.set_back(), changes = clock_.jumps() + clock_.anchored();
  const auto time = clock_.take(by_sender ? frame.time : now, now, used);
  if (clock_.set_back() != set_back) playout_.cut();
  // Session time continues evenly, but the human may not: the delay may have become shorter.
  if (clock_.jumps() + clock_.anchored() != changes) limiter_.set_off_slowly();
  statistics_.clock_jumps = clock_.jumps();
  statistics_.clock_anchors = clock_.anchored();
  if (!time) {
    ++statistics_.late;
    return;
  }
  // An emptied queue no longer contains the frame that was shown, so compare with its time.
  if (queue_.empty() && *time <= used) {
    ++statistics_.late;
    queue_.note_old(*time, now);
    return;
  }
  if (queue_.continues_set_back(*time, now, clock_.rate())) limiter_.set_off_slowly();
  if (!queue_.empty() && *time <= queue_.newest()) queue_.note_old(*time, now);
  const double bridged = kMaxBridgedGap * std::max(1.0, clock_.rate());
  switch (queue_.push(*time, frame.world_from_bone, now, bridged, by_sender)) {
    case FrameQueue::Taken::kYes:
      playout_.observe(queue_, clock_);
      break;
    case FrameQueue::Taken::kDoubled:
      ++statistics_.doubled;
      break;
    case FrameQueue::Taken::kLate:
      ++statistics_.late;
      break;
  }
  statistics_.lost = queue_.lost();
  statistics_.teleports = static_cast<int>(queue_.teleports());
}

bool LiveSession::Impl::begin() {
  if (begun_) return true;
  if (queue_.empty()) return false;
  playout_.begin(queue_.known_since(queue_.first_time()));
  return begun_ = true;
}

std::optional<RobotFrame> LiveSession::Impl::pull(double now) {
  constexpr double kNow = 1e-9;
  if (!begin()) return std::nullopt;
  if (finished_) return show_rest();
  if (!is_live_time(now)) return std::nullopt;
  for (;;) {
    const Playout::Slot slot = playout_.next(queue_, clock_);
    if (now < slot.at - kNow) return std::nullopt;
    if (auto frame = leave(slot)) return frame;
  }
}

std::optional<double> LiveSession::Impl::due() const {
  if (!begun_) return std::nullopt;
  return playout_.next(queue_, clock_).at;
}

void LiveSession::Impl::skip_to(double now) {
  if (!begun_ || !is_live_time(now)) return;
  const double away = now - playout_.next(queue_, clock_).at;
  if (away <= 0.0) return;
  statistics_.missed += playout_.skip_to(now);
  if (away > kPatience) limiter_.set_off_slowly();
}

std::optional<RobotFrame> LiveSession::Impl::leave(const Playout::Slot& slot) {
  if (slot.skips) statistics_.skipped += queue_.between(playout_.time(), slot.time);
  bool cut = slot.skips;
  if (!queue_.empty()) {
    cut = queue_.sample(slot.time, human_) || cut;
    has_human_ = true;
  }
  playout_.take(slot, queue_, clock_);
  note(slot);
  const double missing = playout_.starved() - kPatience - queue_.interval() / clock_.rate();
  if (missing > 0.0) {
    if (!std::exchange(absent_, true)) ++statistics_.interruptions;
    const bool stands = missing > options_.hold_s;
    if (!hold(missing)) return std::nullopt;
    return show(slot, stands ? LiveState::kStanding : LiveState::kHolding);
  }
  const bool is_new = has_human_ && playout_.starved() == 0.0;
  if (is_new && (absent_ || cut)) {
    if (!std::exchange(absent_, false)) ++statistics_.interruptions;
    interrupt(slot.at);
  }
  if (is_new || (has_human_ && has_window())) {
    if (feed(human_)) return show(slot, LiveState::kFollowing);
    // The window is still filling; hold the pose if there is one.
    if (!limiter_.has_begun()) return std::nullopt;
    return show(slot, LiveState::kHolding);
  }
  if (!limiter_.has_begun()) return std::nullopt;
  return show(slot, has_human_ ? LiveState::kFollowing : LiveState::kHolding);
}

void LiveSession::Impl::note(const Playout::Slot& slot) {
  statistics_.sender_rate = clock_.rate();
  statistics_.jitter_s = clock_.jitter();
  statistics_.frame_rate = queue_.interval() > 0.0 ? clock_.rate() / queue_.interval() : 0.0;
  statistics_.delay_s = (clock_.now(slot.at) - slot.time) / clock_.rate();
}

// Solves one human pose.
// @return whether there is a new configuration to show
bool LiveSession::Impl::feed(const HumanPose& human) {
  const OnlineSolver::Outcome outcome = solver_->push(human);
  if (outcome == OnlineSolver::Outcome::kFailed) {
    ++statistics_.bad;
    return limiter_.has_begun();
  }
  if (has_window()) {
    window_.enter(playout_.time());
    statistics_.failed_steps += solver_->take_failed_steps();
  }
  if (outcome == OnlineSolver::Outcome::kFilling) return false;
  if (has_window()) window_.leave();
  std::ranges::copy(solver_->qpos(), wanted_.begin());
  return true;
}

// Produces a frame without input: the robot holds its pose, then returns to standing. It does not
// complete the motion in the window, because no human leads it any more.
// @param seconds  time for which frames have been missing.
// @return whether there is a configuration to show
bool LiveSession::Impl::hold(double seconds) {
  if (seconds > options_.hold_s) {
    if (state_ != LiveState::kStanding) {
      limiter_.set_off_slowly();
      if (limiter_.has_begun()) standing_.place(limiter_.qpos());
    }
    std::ranges::copy(standing_.qpos(), wanted_.begin());
  }
  return limiter_.has_begun();
}

// Handles a discontinuity: discards all state that depends on earlier frames.
void LiveSession::Impl::interrupt(double now) {
  constexpr double kSeldom = 0.25;  // Seconds; limits how often the slow search runs.
  const bool settles = now - settled_ >= kSeldom;
  if (settles) settled_ = now;
  solver_->restart(settles);
  window_.restart();
  limiter_.set_off_slowly();
  if (limiter_.has_begun()) std::ranges::copy(limiter_.qpos(), wanted_.begin());
}

void LiveSession::Impl::limit(const Playout::Slot& slot, LiveState state) {
  if (state == LiveState::kHolding) {
    // The last target may be far away, so the robot stops where it is.
    catches_up_ = false;
    if (limiter_.stop(slot.step)) ++statistics_.limited;
    return;
  }
  const bool limits =
      options_.limit_speeds || state != LiveState::kFollowing || limiter_.sets_off() || catches_up_;
  if (!limits) {
    limiter_.take(wanted_, slot.step);
    return;
  }
  catches_up_ = limiter_.follow(wanted_, slot.step);
  if (catches_up_) ++statistics_.limited;
}

RobotFrame LiveSession::Impl::show(const Playout::Slot& slot, LiveState state) {
  state_ = state;
  limit(slot, state);
  if (state != LiveState::kFollowing) ++statistics_.held;
  return {statistics_.robot_frames++,
          has_window() ? window_.time() : slot.time,
          state,
          limiter_.qpos(),
          slot.at,
          slot.since};
}

// Returns the remaining frames: first those received but not shown, then those of the window.
std::optional<RobotFrame> LiveSession::Impl::show_rest() {
  for (;;) {
    const Playout::Slot slot = playout_.next(queue_, clock_);
    if (slot.known && !queue_.empty()) {
      if (auto frame = leave(slot)) return frame;
      continue;
    }
    // A robot that holds its pose does not move again at the end.
    if (!has_window() || !has_human_ || (absent_ && limiter_.has_begun())) return std::nullopt;
    const bool has_rest = solver_->take_rest();
    statistics_.failed_steps += solver_->take_failed_steps();
    if (!has_rest) return std::nullopt;
    std::ranges::copy(solver_->qpos(), wanted_.begin());
    window_.leave();
    return show(playout_.take_rest(), LiveState::kFollowing);
  }
}

void LiveSession::Impl::reset() {
  solver_->reset();
  clock_ = SenderClock();
  queue_ = FrameQueue();
  playout_ = Playout(rate_.frame_time(), options_.delay_s);
  limiter_.reset();
  state_ = LiveState::kWaiting;
  statistics_ = {};
  has_human_ = finished_ = begun_ = absent_ = catches_up_ = false;
  settled_ = -std::numeric_limits<double>::infinity();
  window_.restart();
}

void LiveSession::Impl::recalibrate(std::unique_ptr<OnlineSolver> solver) {
  solver_ = std::move(solver);
  clock_.restart();
  queue_.clear();
  playout_.cut();
  has_human_ = false;
  // Before the first frame there is nothing to interrupt.
  if (begun_) ++statistics_.interruptions;
  // The first frame of the new body is solved from several starts.
  settled_ = -std::numeric_limits<double>::infinity();
  absent_ = true;
  limiter_.set_off_slowly();
  if (limiter_.has_begun()) std::ranges::copy(limiter_.qpos(), wanted_.begin());
}

LiveSession::Body::Body(std::unique_ptr<OnlineSolver> made) : made_(std::move(made)) {}
LiveSession::Body::~Body() = default;
LiveSession::Body::Body(Body&&) noexcept = default;
LiveSession::Body& LiveSession::Body::operator=(Body&&) noexcept = default;

Result<LiveSession::Body> LiveSession::prepare(const Plan& plan, const LiveOptions& options,
                                               const Robot& robot) {
  if (plan.robot.robot->configuration_size() != robot.configuration_size()) {
    return usage_failure("a stream cannot change its robot");
  }
  RETARGET_TRY_ASSIGN(auto solver, make_solver(plan, options));
  return Body(std::move(solver));
}

void LiveSession::recalibrate(Body body) {
  impl_->recalibrate(std::move(body.made_));
}

Result<LiveSession> LiveSession::make(const Plan& plan, const LiveOptions& options) {
  RETARGET_TRY_ASSIGN(auto solver, make_solver(plan, options));
  return LiveSession(std::make_unique<Impl>(plan, options, std::move(solver)));
}

LiveSession::LiveSession(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LiveSession::~LiveSession() = default;
LiveSession::LiveSession(LiveSession&&) noexcept = default;
LiveSession& LiveSession::operator=(LiveSession&&) noexcept = default;

void LiveSession::push(const HumanFrame& frame, double now) {
  impl_->push(frame, now);
}
std::optional<RobotFrame> LiveSession::pull(double now) {
  return impl_->pull(now);
}
void LiveSession::finish() {
  impl_->finish();
}
void LiveSession::reset() {
  impl_->reset();
}
Result<void> LiveSession::recalibrate(const Plan& plan) {
  RETARGET_TRY_ASSIGN(Body body, prepare(plan, impl_->options(), robot()));
  recalibrate(std::move(body));
  return {};
}
std::optional<double> LiveSession::due() const {
  return impl_->due();
}
void LiveSession::skip_to(double now) {
  impl_->skip_to(now);
}
const LiveStatistics& LiveSession::statistics() const {
  return impl_->statistics();
}
LiveState LiveSession::state() const {
  return impl_->state();
}
const Robot& LiveSession::robot() const {
  return impl_->robot();
}

}  // namespace retarget
