// The guarantee of live mode for streams with random faults: positions, speeds and accelerations
// within their limits in real time, no gap, no more frames than the rate, finite values.
// RETARGET_LIVE_STREAMS=N tries N streams instead of the default number, RETARGET_LIVE_SEED=N sets
// the first seed.

#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>
#include <string>
#include <utility>

#include "live/random_stream.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

constexpr double kRounding = 1e-6;
constexpr double kLongestStep = 1.6;  // Frames; a longer one is a pause of the process.

std::int64_t from_environment(const char* name, std::int64_t usual) {
  const char* text = std::getenv(name);
  return text == nullptr ? usual : std::atoll(text);
}

// Checks the properties that a controller relies on.
class Watcher {
 public:
  Watcher(const Plan& plan, const LiveOptions& options)
      : robot_(*plan.robot.robot), plan_(plan), options_(options), frame_(1.0 / options.fps) {
    const std::size_t joints = robot_.joints().size();
    now_.velocity.assign(joints, 0.0);
    seconds_ = frame_;
    before_ = now_;
  }

  // The process was stopped in between.
  void stopped() { stopped_ = true; }

  // @return the violated property; empty: none
  std::string see(const RobotFrame& frame, int interruptions) {
    for (const double value : frame.qpos) {
      if (!std::isfinite(value)) return "a value that is not finite";
    }
    if (frame.index != count_) return "an index is left out";
    if (std::string wrong = see_positions(frame); !wrong.empty()) return wrong;
    if (count_++ > 0) {
      if (std::string wrong = see_time(frame); !wrong.empty()) return wrong;
      if (std::string wrong = see_motion(frame, interruptions); !wrong.empty()) return wrong;
    }
    qpos_.assign(frame.qpos.begin(), frame.qpos.end());
    due_ = frame.due;
    state_ = frame.state;
    interruptions_ = interruptions;
    stopped_ = false;
    return {};
  }

 private:
  struct Motion {
    std::vector<double> velocity;  // of joints
    Eigen::Vector3d root = Eigen::Vector3d::Zero(), turn = Eigen::Vector3d::Zero();
  };

  std::string see_positions(const RobotFrame& frame) const {
    for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
      const double value = frame.qpos[static_cast<std::size_t>(robot_.joints()[j].qpos_address)];
      if (value < plan_.limits.lower[j] || value > plan_.limits.upper[j]) {
        return robot_.joints()[j].name + " is beyond its limits";
      }
    }
    const Eigen::Map<const Eigen::Vector4d> rotation(frame.qpos.data() + 3);
    return std::abs(rotation.norm() - 1.0) > kRounding ? "an invalid rotation" : "";
  }

  std::string see_time(const RobotFrame& frame) {
    const double gap = frame.due - due_;
    if (gap < 0.4 * frame_) return "two frames too near";
    if (!stopped_ && gap > kLongestStep * frame_) return "a gap of " + std::to_string(gap) + " s";
    latest_.push_back(frame.due);
    while (latest_.front() <= frame.due - 1.0) latest_.pop_front();
    if (static_cast<double>(latest_.size()) > 1.01 * options_.fps + 2.0) {
      return std::to_string(latest_.size()) + " frames in a second";
    }
    return {};
  }

  [[nodiscard]] double ramped(double first, double full, double due) const {
    if (begin_ < 0.0) return full;
    return std::min(full, first + (full - first) * (due - begin_) / options_.limits.resume_s);
  }

  // Speed and its change are bounded in real time; a joint that is too fast brakes. The speed is
  // bounded for evenly spaced frames as well.
  [[nodiscard]] std::string bounded(const std::string& what, double speed, double before,
                                    double change, double most_speed, double most_change) const {
    if (change > most_change + kRounding * 1e3) {
      return what + " changes by " + std::to_string(change) + " of " + std::to_string(most_change);
    }
    const double even = std::min(frame_, seconds_) / seconds_;
    if (speed > std::max(even * most_speed, before - most_change) + kRounding * 1e2) {
      return what + " moves with " + std::to_string(speed) + " of " + std::to_string(most_speed);
    }
    return {};
  }

  std::string see_motion(const RobotFrame& frame, int interruptions) {
    const double gap = frame.due - due_;
    const double seconds = gap <= kLongestStep * frame_ ? gap : frame_;
    const double apart = 0.5 * (std::exchange(seconds_, seconds) + seconds);
    // It resumes gently from its position; the ramp begins with the first frame after an
    // interruption.
    const bool stands = frame.state == LiveState::kStanding && state_ != LiveState::kStanding;
    if (stands || (interruptions != interruptions_ && frame.state == LiveState::kFollowing) ||
        (state_ != LiveState::kFollowing && frame.state == LiveState::kFollowing &&
         options_.mode == LiveMode::kFrame)) {
      begin_ = frame.due - std::min(seconds, frame_);
    }
    std::swap(now_, before_);
    const LiveLimits& limits = options_.limits;
    for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
      const auto at = static_cast<std::size_t>(robot_.joints()[j].qpos_address);
      now_.velocity[j] = (frame.qpos[at] - qpos_[at]) / seconds;
      const double full = std::min({robot_.speed_limit(static_cast<int>(j)),
                                    plan_.fit.max_joint_speed, plan_.fit.max_joint_step / frame_});
      const std::string wrong = bounded(
          robot_.joints()[j].name, std::abs(now_.velocity[j]), std::abs(before_.velocity[j]),
          std::abs(now_.velocity[j] - before_.velocity[j]),
          ramped(limits.resume_joint_speed, full, frame.due), limits.joint_acceleration * apart);
      if (!wrong.empty()) return wrong;
    }
    const Eigen::Map<const Eigen::Vector3d> a(qpos_.data()), b(frame.qpos.data());
    now_.root = (b - a) / seconds;
    std::string wrong = bounded("the root", now_.root.norm(), before_.root.norm(),
                                (now_.root - before_.root).norm(),
                                ramped(limits.resume_root_speed, limits.root_speed, frame.due),
                                limits.root_acceleration * apart);
    if (!wrong.empty()) return wrong;
    const Eigen::Quaterniond from(qpos_[3], qpos_[4], qpos_[5], qpos_[6]);
    const Eigen::Quaterniond to(frame.qpos[3], frame.qpos[4], frame.qpos[5], frame.qpos[6]);
    now_.turn = log_so3(from.conjugate() * to) / seconds;
    return bounded("the root's rotation", now_.turn.norm(), before_.turn.norm(),
                   (now_.turn - before_.turn).norm(),
                   ramped(limits.resume_turn_speed, limits.turn_speed, frame.due),
                   limits.turn_acceleration * apart);
  }

  const Robot& robot_;
  const Plan& plan_;
  LiveOptions options_;
  double frame_;
  Motion now_, before_;
  std::vector<double> qpos_;
  std::deque<double> latest_;
  double due_ = 0.0, begin_ = -1.0;
  double seconds_ = 0.0;  // Duration of the latest step.
  LiveState state_ = LiveState::kWaiting;
  int interruptions_ = 0;
  std::int64_t count_ = 0;
  bool stopped_ = false;
};

struct Bodies {
  const Plan& plan;
  const HumanClip& human;
  const Plan& other;
};

// @return the violated property of a stream's robot frames; empty: none
std::string fault_of(std::uint64_t seed, const Bodies& bodies, LiveMode mode, double& seconds) {
  RandomStream stream = random_stream(seed, bodies.human);
  stream.options.mode = mode;
  stream.options.lag_s = 0.1;
  LiveSession session = LiveSession::make(bodies.plan, stream.options).value();
  Watcher watcher(bodies.plan, stream.options);
  std::string wrong;
  const auto take = [&](double now) {
    while (wrong.empty()) {
      const auto frame = session.pull(now);
      if (!frame) return;
      wrong = watcher.see(*frame, session.statistics().interruptions);
      if (frame->due > now + kRounding) wrong = "a frame of the future";
    }
  };
  double away = 0.0;
  for (const StreamIncident& incident : stream.incidents) {
    const double now = std::max(incident.at, away);
    switch (incident.kind) {
      case StreamIncident::Kind::kFrame:
        take(now - 2e-6);
        session.push(incident.frame, now);
        take(now);
        break;
      case StreamIncident::Kind::kStop:
        take(now);
        away = std::max(away, incident.until);
        session.skip_to(away);
        watcher.stopped();
        take(away);
        break;
      case StreamIncident::Kind::kNewBody:
        take(now);
        EXPECT_TRUE(session.recalibrate(bodies.other));
        break;
    }
    if (!wrong.empty()) break;
  }
  const double end = std::max(stream.end, away) + 0.3;
  take(end);
  seconds += end;
  const LiveStatistics& seen = session.statistics();
  if (wrong.empty() && seen.received > seen.bad + seen.late && seen.robot_frames == 0 &&
      mode == LiveMode::kFrame) {
    wrong = "no frame at all of " + std::to_string(seen.received) + ", " +
            std::to_string(seen.bad) + " bad, " + std::to_string(seen.late) + " late";
  }
  return wrong;
}

// Tries every step-th of `count` streams, starting at `begin`.
void try_streams(std::int64_t count, const Bodies& bodies, LiveMode mode, std::int64_t begin = 0,
                 std::int64_t step = 1) {
  const auto first = static_cast<std::uint64_t>(from_environment("RETARGET_LIVE_SEED", 1));
  double seconds = 0.0;
  int faults = 0;
  for (std::int64_t i = begin; i < count && faults < 5; i += step) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(i);
    const std::string wrong = fault_of(seed, bodies, mode, seconds);
    if (wrong.empty()) continue;
    ++faults;
    ADD_FAILURE() << "stream " << seed << ": " << wrong;
  }
  ::testing::Test::RecordProperty("seconds_of_streams", std::to_string(seconds));
}

// Parts of the streams, so that several processes can share the work.
constexpr int kParts = 4;
class RandomStreams : public testing::TestWithParam<int> {};

TEST_P(RandomStreams, SatisfyTheGuarantee) {
  const Plan plan = sample_plan("walk", Method::kGmr), other = sample_plan("squat", Method::kGmr);
  const HumanClip human = human_of(plan);
  try_streams(from_environment("RETARGET_LIVE_STREAMS", 10000), {plan, human, other},
              LiveMode::kFrame, GetParam(), kParts);
}

INSTANTIATE_TEST_SUITE_P(Part, RandomStreams, testing::Range(0, kParts));

TEST(LiveGuarantee, HoldsWithFeetAndFloor) {
  const Plan plan = sample_plan("walk", Method::kFit), other = sample_plan("squat", Method::kFit);
  const HumanClip human = human_of(plan);
  const std::int64_t count = from_environment("RETARGET_LIVE_STREAMS", 10000) / 50;
  try_streams(count, {plan, human, other}, LiveMode::kFrame);
  try_streams(count / 4, {plan, human, other}, LiveMode::kLag);
}

TEST(LiveGuarantee, HoldsForArmsAlone) {
  const Plan plan = sample_plan("walk", Method::kFit, sample_robot_arms());
  const Plan other = sample_plan("squat", Method::kFit, sample_robot_arms());
  const HumanClip human = human_of(plan);
  const std::int64_t count = from_environment("RETARGET_LIVE_STREAMS", 10000) / 50;
  try_streams(count, {plan, human, other}, LiveMode::kFrame);
  try_streams(count / 4, {plan, human, other}, LiveMode::kLag);
}

}  // namespace
}  // namespace retarget
