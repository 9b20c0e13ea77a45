#include "retarget/live.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "live/floor_finder.h"
#include "live/foot_holder.h"
#include "live/frame_queue.h"
#include "live/lag_fit.h"
#include "live/live_table.h"
#include "live/live_targets.h"
#include "live/motion_limiter.h"
#include "live/sender_clock.h"
#include "live/standing_pose.h"

namespace retarget {
namespace {

constexpr double kPatience =
    0.1;                         // seconds that a frame may be overdue before it counts as missing
constexpr double kTooFar = 1e5;  // metres from the origin

Result<void> check_options(const Plan& plan, const LiveOptions& options) {
  LiveOptions given = options;
  for (const Option& row : live_table(given)) {
    auto sound = check_option(row, row.get());
    if (!sound) return usage_failure(marked_option(row.name) + ": " + sound.error().message);
  }
  if (options.mode == LiveMode::kLag && plan.options.solve.method != Method::kFit) {
    return usage_failure(
        "a lag is for the method fit, which looks ahead; gmr solves single frames");
  }
  if (!plan.clip || plan.clip->frame_count() == 0) {
    return usage_failure("a stream needs a plan with frames of the body that will move");
  }
  return {};
}

bool is_sound(const HumanPose& human) {
  return std::ranges::all_of(human, [](const Pose& pose) {
    return pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
           pose.translation.cwiseAbs().maxCoeff() < kTooFar && pose.rotation.norm() > 1e-6;
  });
}

}  // namespace

// what belongs to a body
struct LiveBody {
  LiveBody(std::unique_ptr<LiveTargets> made, const LiveOptions& options, double frame_time)
      : targets(std::move(made)),
        feet(live_feet(targets->model(), frame_time)),
        floor(targets->options(), frame_time),
        holder(targets->model(), targets->options(), frame_time, feet.size()) {
    if (options.mode != LiveMode::kLag) return;
    const auto frames = static_cast<int>(std::lround(options.lag_s / frame_time));
    lag.emplace(*targets, frame_time, frames);
  }

  void restart() {
    targets->settle_next();
    for (LiveFoot& foot : feet) foot.restart();
    holder.restart();
    if (lag) lag->restart();
  }

  std::unique_ptr<LiveTargets> targets;
  std::vector<LiveFoot> feet;
  FloorFinder floor;
  FootHolder holder;
  std::optional<LagFit> lag;
};

class LiveSession::Impl {
 public:
  Impl(const Plan& plan, const LiveOptions& options, std::unique_ptr<LiveTargets> targets)
      : options_(options),
        rate_(frame_rate_from_fps(options.fps)),
        body_(std::make_unique<LiveBody>(std::move(targets), options, rate_.frame_time())),
        limiter_(*plan.robot.robot, plan.limits, plan.fit),
        wanted_(plan.robot.robot->zero_configuration()),
        standing_(*plan.robot.robot, plan.limits) {}

  void push(const HumanFrame& frame, double now);
  std::optional<RobotFrame> pull(double now);
  void finish() { finished_ = true; }
  void reset();
  Result<void> recalibrate(const Plan& plan);

  [[nodiscard]] const LiveStatistics& statistics() const { return statistics_; }
  [[nodiscard]] LiveState state() const { return state_; }
  [[nodiscard]] const Robot& robot() const { return body_->targets->robot(); }

 private:
  [[nodiscard]] double tick_time() const { return origin_ + rate_.time_of(tick_); }
  bool feed(const HumanPose& human);
  bool hold();
  void interrupt();
  void take_next_of_lag();
  RobotFrame show(LiveState state);
  std::optional<RobotFrame> show_rest();
  std::optional<RobotFrame> show_tick(bool made, LiveState state);

  LiveOptions options_;
  FrameRate rate_;
  std::unique_ptr<LiveBody> body_;
  SenderClock clock_;
  FrameQueue queue_;
  MotionLimiter limiter_;
  LiveState state_ = LiveState::kWaiting;
  LiveStatistics statistics_;
  HumanPose human_;             // the latest that was solved
  std::vector<double> wanted_;  // of the robot
  StandingPose standing_;
  bool has_human_ = false, finished_ = false;
  bool begun_ = false;
  double origin_ = 0.0;  // session time of tick 0
  std::int64_t tick_ = 0;
  std::int64_t missing_ = 0;  // ticks in a row
};

void LiveSession::Impl::push(const HumanFrame& frame, double now) {
  ++statistics_.received;
  if (!is_sound(frame.world_from_bone)) {
    ++statistics_.bad;
    return;
  }
  const bool by_sender = options_.clock == LiveClock::kSender && std::isfinite(frame.time);
  const auto time = clock_.take(by_sender ? frame.time : now, now);
  statistics_.clock_jumps = clock_.jumps();
  if (!time) {
    ++statistics_.late;
    return;
  }
  switch (queue_.push(*time, frame.world_from_bone)) {
    case FrameQueue::Taken::kYes:
      break;
    case FrameQueue::Taken::kDoubled:
      ++statistics_.doubled;
      break;
    case FrameQueue::Taken::kLate:
      ++statistics_.late;
      break;
  }
  statistics_.lost = queue_.lost();
}

std::optional<RobotFrame> LiveSession::Impl::pull(double now) {
  constexpr double kNow = 1e-9;
  if (!begun_) {
    if (queue_.empty()) return std::nullopt;
    begun_ = true;
    origin_ = queue_.first_time();
    tick_ = 0;
  }
  for (;;) {
    const double due = tick_time() + options_.delay_s;
    const double overdue = clock_.now(now) - due;
    if (!finished_ && options_.delay_s > 0.0 && overdue < -kNow) return std::nullopt;
    switch (queue_.sample(tick_time(), human_)) {
      case FrameQueue::Found::kYes: {
        missing_ = 0;
        has_human_ = true;
        const bool made = feed(human_);
        ++tick_;
        if (auto frame = show_tick(made, LiveState::kFollowing)) return frame;
        break;
      }
      case FrameQueue::Found::kGap: {
        const double next = queue_.next_time(tick_time());
        const auto ticks =
            static_cast<std::int64_t>(std::ceil((next - origin_) * rate_.fps() - 1e-6));
        tick_ = std::max(tick_ + 1, ticks);
        interrupt();
        break;
      }
      case FrameQueue::Found::kNotYet: {
        if (finished_) return show_rest();
        if (overdue < kPatience + queue_.interval()) return std::nullopt;
        ++missing_;
        const bool made = hold();
        ++tick_;
        const bool stands = static_cast<double>(missing_) * rate_.frame_time() > options_.hold_s;
        if (auto frame = show_tick(made, stands ? LiveState::kStanding : LiveState::kHolding)) {
          return frame;
        }
        break;
      }
    }
  }
}

// @return whether there is something new to show
bool LiveSession::Impl::feed(const HumanPose& human) {
  LiveTargets& targets = *body_->targets;
  targets.build(human);
  const Eigen::Vector3d path = targets.path();
  for (LiveFoot& foot : body_->feet) foot.add(human, targets.world_from_target(), path);
  const bool frame_mode = !body_->lag;
  const bool with_floor = !frame_mode || options_.floor;
  const double floor = with_floor ? body_->floor.add(body_->feet) : 0.0;
  if (frame_mode && options_.hold_feet) {
    body_->holder.hold(body_->feet, floor, path, targets.world_from_target());
  }
  if (!targets.solve()) {
    ++statistics_.bad;
    return limiter_.has_begun();
  }
  if (!frame_mode) {
    body_->lag->push(human, targets.world_from_target(), targets.qpos(), path, floor);
    if (!body_->lag->has_next()) return false;
    take_next_of_lag();
    return true;
  }
  std::ranges::copy(targets.qpos(), wanted_.begin());
  for (std::size_t k = 0; k < 3; ++k) wanted_[k] += path[static_cast<int>(k)];
  wanted_[2] -= floor;
  if (options_.floor && !robot().fixed_base()) body_->holder.stand(body_->feet, wanted_);
  return true;
}

void LiveSession::Impl::take_next_of_lag() {
  std::ranges::copy(body_->lag->next(), wanted_.begin());
}

// A tick without a human: the last one is still there, then nobody.
bool LiveSession::Impl::hold() {
  const double seconds = static_cast<double>(missing_) * rate_.frame_time();
  if (seconds > options_.hold_s) {
    if (state_ != LiveState::kStanding) {
      limiter_.set_off_slowly();
      if (limiter_.has_begun()) standing_.place(limiter_.qpos());
    }
    std::ranges::copy(standing_.qpos(), wanted_.begin());
    return limiter_.has_begun();
  }
  if (missing_ == 1) ++statistics_.interruptions;
  if (has_human_ && body_->lag && missing_ > 0) return feed(human_);
  return limiter_.has_begun();
}

// What comes next has nothing to do with what came before.
void LiveSession::Impl::interrupt() {
  if (missing_ == 0) ++statistics_.interruptions;
  missing_ = 0;
  body_->restart();
  limiter_.set_off_slowly();
  if (limiter_.has_begun()) std::ranges::copy(limiter_.qpos(), wanted_.begin());
}

std::optional<RobotFrame> LiveSession::Impl::show_tick(bool made, LiveState state) {
  if (made) return show(state);
  // a window fills: until then the robot is as it was, if it was
  if (!limiter_.has_begun()) return std::nullopt;
  return show(LiveState::kHolding);
}

RobotFrame LiveSession::Impl::show(LiveState state) {
  state_ = state;
  if (options_.limit_speeds || state != LiveState::kFollowing) {
    if (limiter_.follow(wanted_, rate_.frame_time())) ++statistics_.limited;
  } else {
    limiter_.take(wanted_);
  }
  if (state != LiveState::kFollowing) ++statistics_.held;
  const int lag = body_->lag ? body_->lag->lag_frames() : 0;
  return {statistics_.robot_frames++, origin_ + rate_.time_of(tick_ - 1 - lag), state,
          limiter_.qpos()};
}

std::optional<RobotFrame> LiveSession::Impl::show_rest() {
  if (!body_->lag || !has_human_) return std::nullopt;
  LagFit& lag = *body_->lag;
  if (!lag.is_finished()) lag.finish();
  if (!lag.has_next()) return std::nullopt;
  take_next_of_lag();
  ++tick_;
  return show(LiveState::kFollowing);
}

void LiveSession::Impl::reset() {
  body_->restart();
  body_->floor.restart();
  clock_ = SenderClock();
  queue_.clear();
  limiter_.reset();
  state_ = LiveState::kWaiting;
  statistics_ = {};
  has_human_ = finished_ = begun_ = false;
  tick_ = missing_ = 0;
}

Result<void> LiveSession::Impl::recalibrate(const Plan& plan) {
  TRY(check_options(plan, options_));
  if (plan.robot.robot->configuration_size() != robot().configuration_size()) {
    return usage_failure("a stream goes on with the robot that it began with");
  }
  TRY_ASSIGN(auto targets, LiveTargets::make(plan));
  body_ = std::make_unique<LiveBody>(std::move(targets), options_, rate_.frame_time());
  clock_.restart();
  queue_.clear();
  has_human_ = false;
  interrupt();
  return {};
}

Result<LiveSession> LiveSession::make(const Plan& plan, const LiveOptions& options) {
  TRY(check_options(plan, options));
  TRY_ASSIGN(auto targets, LiveTargets::make(plan));
  return LiveSession(std::make_unique<Impl>(plan, options, std::move(targets)));
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
  return impl_->recalibrate(plan);
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
