// Faults of networks and senders in a stream, and the robot's response. The tests supply the time,
// so that every run is the same.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "live/live_sample.h"
#include "live/session/sender_clock.h"
#include "motion/resample.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// The walker at any time; it stands before and after.
HumanPose walker_at(double time) {
  const HumanClip& human = walking_human();
  const double frame = std::clamp(time * human.rate.fps(), 0.0, human.frame_count - 1.001);
  const int before = static_cast<int>(frame);
  HumanPose pose;
  for (const Bone bone : kAllBones) {
    const Pose &a = human.frame(before)[bone], &b = human.frame(before + 1)[bone];
    pose[bone] = {interpolate_linear(a.rotation, b.rotation, frame - before),
                  interpolate_linear(a.translation, b.translation, frame - before)};
  }
  return pose;
}

// A session with a clock, and all its output.
class Stream {
 public:
  explicit Stream(const LiveOptions& options)
      : session(LiveSession::make(walk_plan(), options).value()) {}

  void frame(double time, double arrival) {
    wait(arrival);
    session.push({time, walker_at(time)}, arrival);
    take(arrival);
  }
  // Lets time pass without frames until then.
  void wait(double until) {
    for (; now_ < until; now_ += 0.001) take(now_);
    now_ = until;
    take(now_);
  }
  void take(double now) {
    while (const auto frame = session.pull(now)) {
      states.push_back(frame->state);
      times.push_back(frame->time);
      due.push_back(frame->due);
      indices.push_back(frame->index);
      qpos.emplace_back(frame->qpos.begin(), frame->qpos.end());
    }
  }

  // No joint and no root ever exceeds its speed limit.
  void expect_no_jump(double fps) const {
    const Robot& robot = session.robot();
    for (std::size_t i = 1; i < qpos.size(); ++i) {
      for (std::size_t j = 0; j < robot.joints().size(); ++j) {
        const auto at = static_cast<std::size_t>(robot.joints()[j].qpos_address);
        ASSERT_LE(std::abs(qpos[i][at] - qpos[i - 1][at]),
                  robot.speed_limit(static_cast<int>(j)) / fps + 1e-9)
            << robot.joints()[j].name << " in frame " << i;
      }
      const Eigen::Map<const Eigen::Vector3d> a(qpos[i - 1].data()), b(qpos[i].data());
      ASSERT_LE((b - a).norm(), 8.0 / fps + 1e-9) << i;
      ASSERT_GE(Eigen::Map<const Eigen::Vector4d>(qpos[i].data() + 3)
                    .dot(Eigen::Map<const Eigen::Vector4d>(qpos[i - 1].data() + 3)),
                0.0)
          << i;
    }
    for (std::size_t i = 0; i < indices.size(); ++i) {
      ASSERT_EQ(indices[i], static_cast<std::int64_t>(i));
    }
  }
  [[nodiscard]] long count(LiveState state) const { return std::ranges::count(states, state); }

  LiveSession session;
  std::vector<LiveState> states;
  std::vector<double> times, due;
  std::vector<std::int64_t> indices;
  std::vector<std::vector<double>> qpos;

 private:
  double now_ = 0.0;
};

LiveOptions at_50() {
  LiveOptions options;
  options.fps = 50.0;
  return options;
}

TEST(LiveRates, AnyRateGivesEvenRobotFrames) {
  for (const double rate : {24.0, 60.0, 90.0, 100.0, 120.0, 240.0}) {
    for (const LiveMode mode : {LiveMode::kFrame, LiveMode::kLag}) {
      LiveOptions options = at_50();
      options.mode = mode;
      options.lag_s = 0.1;
      Stream stream(options);
      for (int i = 0; i <= 2.0 * rate; ++i) stream.frame(i / rate, i / rate + 0.005);
      // Frames leave at the times of our clock, including the first one, which a window delays.
      for (std::size_t i = 1; i < stream.due.size(); ++i) {
        ASSERT_NEAR(stream.due[i] - stream.due[i - 1], 0.02, 0.0062) << rate;
      }
      stream.session.finish();
      stream.take(2.1);
      // At a lower rate a frame is known up to one interval later.
      const double waits = 50.0 / std::min(rate, 50.0);
      EXPECT_GE(stream.qpos.size(), 100U) << rate;
      EXPECT_LE(static_cast<double>(stream.qpos.size()), 102.0 + waits) << rate;
      for (std::size_t i = 1; i < stream.times.size(); ++i) {
        const double step = stream.times[i] - stream.times[i - 1];
        ASSERT_GE(step, 0.0) << rate;
        ASSERT_LE(step, 0.03 + 1e-9) << rate;
        // By then, frames have arrived at every phase relative to the robot frames.
        if (stream.times[i - 1] > 0.6) {
          ASSERT_NEAR(step, 0.02, 1e-9) << rate;
        }
      }
      EXPECT_EQ(stream.session.statistics().held, 0) << rate;
      EXPECT_EQ(stream.session.statistics().lost, 0) << rate;
      stream.expect_no_jump(50.0);
    }
  }
}

TEST(LiveRates, ADelayMakesFramesEven) {
  LiveOptions options = at_50();
  options.delay_s = 0.05;
  LiveSession session = LiveSession::make(walk_plan(), options).value();
  // Frames arrive in pairs, as in some networks.
  std::vector<double> departures;
  int next = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    const double now = 0.001 * tick;
    while (next / 60.0 + (next % 2 == 0 ? 1.0 / 60.0 : 0.0) + 0.01 <= now) {
      session.push({next / 60.0, walker_at(next / 60.0)}, now);
      ++next;
    }
    while (session.pull(now)) departures.push_back(now);
  }
  ASSERT_GT(departures.size(), 90U);
  for (std::size_t i = 10; i < departures.size(); ++i) {
    EXPECT_NEAR(departures[i] - departures[i - 1], 0.02, 0.0021) << i;
  }
}

TEST(LiveRates, ArrivalTimesReplaceMissingTimestamps) {
  LiveOptions options = at_50();
  options.clock = LiveClock::kArrival;
  Stream stream(options);
  for (int i = 0; i < 120; ++i) stream.frame(i / 60.0, i / 60.0 + (i % 3) * 0.002);
  EXPECT_NEAR(static_cast<double>(stream.qpos.size()), 99.0, 2.0);
  EXPECT_EQ(stream.session.statistics().held, 0);
}

TEST(LiveFaults, LostFramesAreInterpolated) {
  Stream stream(at_50());
  std::mt19937 random(7);
  for (int i = 0; i < 180; ++i) {
    if (i > 20 && random() % 5 == 0) continue;
    stream.frame(i / 60.0, i / 60.0 + 0.005);
  }
  EXPECT_GT(stream.session.statistics().lost, 15);
  EXPECT_EQ(stream.session.statistics().held, 0);
  EXPECT_EQ(stream.session.statistics().interruptions, 0);
  stream.expect_no_jump(50.0);
}

TEST(LiveFaults, DoubledAndReorderedFramesChangeNothing) {
  LiveOptions options = at_50();
  options.delay_s = 0.05;
  Stream clean(options), shuffled(options);
  for (int i = 0; i < 120; ++i) clean.frame(i / 60.0, i / 60.0);
  for (int i = 0; i < 120; i += 2) {
    const double now = (i + 1) / 60.0;
    shuffled.frame((i + 1) / 60.0, now);
    shuffled.frame(i / 60.0, now);
    shuffled.frame(i / 60.0, now);
  }
  // Both copies of frame 0 precede the first received frame: they are late, not doubled.
  EXPECT_EQ(shuffled.session.statistics().doubled, 59);
  EXPECT_EQ(shuffled.session.statistics().late, 2);
  const std::size_t common = std::min(clean.qpos.size(), shuffled.qpos.size());
  ASSERT_GT(common, 80U);
  // The first frame arrived second, after its robot frame.
  for (std::size_t i = 0; i + 2 < common; ++i) {
    const auto found = std::ranges::find_if(
        shuffled.times, [&](double time) { return std::abs(time - clean.times[i]) < 1e-9; });
    if (found == shuffled.times.end()) continue;
    const auto at = static_cast<std::size_t>(found - shuffled.times.begin());
    EXPECT_NEAR(shuffled.qpos[at][10], clean.qpos[i][10], 0.02) << i;
  }
  shuffled.expect_no_jump(50.0);
}

TEST(LiveFaults, LateFramesAreDropped) {
  Stream stream(at_50());
  for (int i = 0; i < 60; ++i) stream.frame(i / 60.0, i / 60.0);
  stream.frame(0.2, 1.0);
  EXPECT_EQ(stream.session.statistics().late, 1);
  for (int i = 61; i < 90; ++i) stream.frame(i / 60.0, i / 60.0);
  EXPECT_EQ(stream.session.statistics().held, 0);
}

TEST(LiveFaults, HoldsThePoseThenStandsDuringAStall) {
  for (const LiveMode mode : {LiveMode::kFrame, LiveMode::kLag}) {
    LiveOptions options = at_50();
    options.mode = mode;
    Stream stream(options);
    for (int i = 0; i <= 60; ++i) stream.frame(i / 60.0, i / 60.0);
    stream.wait(2.0);
    EXPECT_EQ(stream.session.state(), LiveState::kHolding);
    stream.wait(7.0);
    EXPECT_EQ(stream.session.state(), LiveState::kStanding);
    // Upright, joints at rest, soles on the floor, and no further movement.
    const auto& stands = stream.qpos.back();
    EXPECT_NEAR(stands[4], 0.0, 1e-6);
    EXPECT_NEAR(stands[5], 0.0, 1e-6);
    EXPECT_NEAR(stands[7], 0.0, 1e-6);
    EXPECT_GT(stands[2], 0.6);
    EXPECT_EQ(stands, stream.qpos[stream.qpos.size() - 2]);
    // Frames continue at their rate.
    EXPECT_NEAR(static_cast<double>(stream.qpos.size()), 7.0 * 50.0, 15.0);
    // The performer walked on meanwhile.
    for (int i = 0; i < 120; ++i) stream.frame(7.0 + i / 60.0, 7.0 + i / 60.0);
    EXPECT_EQ(stream.session.state(), LiveState::kFollowing);
    EXPECT_GE(stream.session.statistics().interruptions, 1);
    stream.expect_no_jump(50.0);
  }
}

TEST(LiveFaults, ResumesSlowlyAfterAStall) {
  Stream stream(at_50());
  for (int i = 0; i <= 60; ++i) stream.frame(i / 60.0, i / 60.0);
  stream.wait(2.0);
  const std::size_t held = stream.qpos.size();
  for (int i = 0; i < 6; ++i) stream.frame(3.5 + i / 60.0, 2.0 + i / 60.0);
  ASSERT_GT(stream.qpos.size(), held);
  for (std::size_t i = held; i < stream.qpos.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3d> a(stream.qpos[i - 1].data()), b(stream.qpos[i].data());
    EXPECT_LT((b - a).norm(), 0.02) << i - held;
  }
}

TEST(LiveFaults, FollowsAClockThatJumps) {
  for (const double jump : {-1000.0, 5000.0}) {
    LiveSession session = LiveSession::make(walk_plan(), at_50()).value();
    int frames = 0, held = 0;
    for (int i = 0; i < 240; ++i) {
      const double now = i / 60.0;
      session.push({now + (i >= 120 ? jump : 0.0), walker_at(now)}, now);
      while (const auto frame = session.pull(now)) {
        ++frames;
        held += frame->state == LiveState::kFollowing ? 0 : 1;
      }
    }
    EXPECT_EQ(session.statistics().clock_jumps, 1) << jump;
    EXPECT_EQ(held, 0) << jump;
    EXPECT_NEAR(frames, 200, 3) << jump;
  }
}

TEST(LiveFaults, ToleratesOneWrongTimestamp) {
  Stream stream(at_50());
  for (int i = 0; i < 60; ++i) stream.frame(i / 60.0, i / 60.0);
  stream.session.push({1e6, walker_at(1.0)}, 1.0);
  for (int i = 61; i < 120; ++i) stream.frame(i / 60.0, i / 60.0);
  EXPECT_EQ(stream.session.statistics().clock_jumps, 0);
  EXPECT_EQ(stream.session.statistics().held, 0);
}

TEST(LiveFaults, UsesDelayedFrames) {
  Stream stream(at_50());
  for (int i = 0; i < 60; ++i) stream.frame(i / 60.0, i / 60.0);
  // Nothing for 0.9 s, then all frames at once.
  for (int i = 60; i < 114; ++i) stream.frame(i / 60.0, 1.9);
  for (int i = 114; i < 240; ++i) stream.frame(i / 60.0, i / 60.0);
  EXPECT_EQ(stream.session.statistics().clock_jumps, 0);
  EXPECT_EQ(stream.session.state(), LiveState::kFollowing);
  stream.expect_no_jump(50.0);
}

TEST(LiveFaults, DropsFramesWithNaN) {
  Stream stream(at_50());
  for (int i = 0; i < 60; ++i) stream.frame(i / 60.0, i / 60.0);
  HumanPose bad = walker_at(1.0);
  bad[Bone::kHead].translation.x() = std::nan("");
  stream.session.push({1.0, bad}, 1.0);
  HumanPose zero = walker_at(1.0);
  zero[Bone::kHips].rotation.coeffs().setZero();
  stream.session.push({1.01, zero}, 1.01);
  EXPECT_EQ(stream.session.statistics().bad, 2);
  for (int i = 62; i < 90; ++i) stream.frame(i / 60.0, i / 60.0);
  for (const auto& qpos : stream.qpos) {
    for (const double value : qpos) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(LiveFaults, ContinuesAtTheRobotsPoseWithAnotherBody) {
  for (const LiveMode mode : {LiveMode::kFrame, LiveMode::kLag}) {
    LiveOptions options = at_50();
    options.mode = mode;
    Stream stream(options);
    for (int i = 0; i <= 60; ++i) stream.frame(i / 60.0, i / 60.0);
    const Plan other = sample_plan("squat", Method::kFit);
    ASSERT_TRUE(stream.session.recalibrate(other));
    const HumanClip squat = human_of(other);
    for (int i = 0; i < 150; ++i) {
      const double now = 1.05 + i / 60.0;
      stream.wait(now);
      // Its clock restarts, too.
      stream.session.push({i / 60.0, squat.frame(i / 2)}, now);
      stream.take(now);
    }
    EXPECT_EQ(stream.session.state(), LiveState::kFollowing);
    stream.expect_no_jump(50.0);
  }
}

TEST(LiveFaults, ResetIsANewStream) {
  LiveSession session = LiveSession::make(walk_plan(), at_50()).value();
  const auto first = streamed(session, walking_human());
  session.reset();
  EXPECT_EQ(session.statistics().received, 0);
  EXPECT_EQ(streamed(session, walking_human(), 100.0).size(), first.size());
}

TEST(SenderClock, FollowsTheFastestFrames) {
  SenderClock clock;
  for (int i = 0; i < 100; ++i) {
    const double stamp = 50.0 + 0.01 * i;
    EXPECT_EQ(clock.take(stamp, 0.01 * i + (i % 7) * 0.003), stamp);
  }
  EXPECT_NEAR(clock.now(1.0), 51.0, 1e-9);
}

}  // namespace
}  // namespace retarget
