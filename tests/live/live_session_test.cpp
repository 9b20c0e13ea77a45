// A stream gives the result of whole clips where possible, and its guarantees hold.

#include "retarget/live.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "live/live_sample.h"
#include "support/counted_allocations.h"
#include "support/value_of.h"

namespace retarget {
namespace {

constexpr double kLongLag = 30.0;  // seconds, longer than any sample

LiveOptions plain_frames(double fps) {
  LiveOptions options;
  options.fps = fps;
  options.limit_speeds = options.floor = options.hold_feet = false;
  return options;
}

LiveOptions with_lag(double fps, double lag_s) {
  LiveOptions options;
  options.mode = LiveMode::kLag;
  options.fps = fps;
  options.lag_s = lag_s;
  return options;
}

LiveSession session_of(const Plan& plan, const LiveOptions& options) {
  return value_of(LiveSession::make(plan, options));
}

// The motion of a stream's frames, for measurement.
Motion motion_of(const Plan& plan, const std::vector<std::vector<double>>& frames) {
  Motion motion;
  motion.source = plan.clip;
  motion.plan = plan;
  motion.clip = RobotClip(plan.robot.robot, plan.rate, static_cast<int>(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    std::ranges::copy(frames[i], motion.clip.qpos(static_cast<int>(i)).begin());
  }
  return motion;
}

TEST(LiveFrames, EqualThoseOfThePublishedMethod) {
  for (const char* name : {"walk", "squat", "turn_in_place", "wave", "get_up"}) {
    const Plan plan = sample_plan(name, Method::kGmr);
    const auto offline = value_of(solve(plan));
    LiveSession session = session_of(plan, plain_frames(plan.rate.fps()));
    const auto frames = streamed(session, human_of(plan));
    ASSERT_EQ(static_cast<int>(frames.size()), offline.clip.frame_count()) << name;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const auto expected = offline.clip.qpos(static_cast<int>(i));
      for (std::size_t j = 0; j < expected.size(); ++j) {
        ASSERT_NEAR(frames[i][j], expected[j], 1e-9) << name << ", frame " << i << ", value " << j;
      }
    }
    EXPECT_EQ(session.statistics().held, 0);
  }
}

// A stream starts with a headstand: the robot does not lie on the floor.
TEST(LiveFrames, StartUpsideDown) {
  const Plan plan = sample_plan("wave", Method::kFit);
  HumanClip human = human_of(plan);
  human.frame_count = 30;
  human.world_from_bone.resize(30);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  for (HumanPose& pose : human.world_from_bone) {
    const double head = pose[Bone::kHead].translation.z();
    for (Pose& bone : pose) {
      bone.translation = turn * bone.translation + Eigen::Vector3d(0.0, 0.0, head + 0.17);
      bone.rotation = turn * bone.rotation;
    }
  }
  const double fps = plan.rate.fps();
  for (LiveOptions options : {with_lag(fps, 0.2), LiveOptions()}) {
    options.fps = fps;
    LiveSession session = session_of(plan, options);
    const auto frames = streamed(session, human);
    ASSERT_FALSE(frames.empty());
    EXPECT_GT(frames.back()[2], 0.5);
    EXPECT_LT(frames.back()[2], 0.8);
  }
}

// Height of the root at the end of a stream whose human is raised by `height_at(seconds)`, of a
// sender whose clock has this rate.
double last_height(const Plan& plan, double rate, const std::function<double(double)>& height_at) {
  const HumanClip human = human_of(plan);
  LiveSession session = session_of(plan, LiveOptions());
  double height = 0.0;
  for (int i = 0; i < 2 * human.frame_count; ++i) {
    // The clip forwards, then backwards.
    const int last = human.frame_count - 1, frame = i <= last ? i : 2 * last + 1 - i;
    HumanPose pose = human.frame(frame);
    const double time = human.rate.time_of(i);
    for (Pose& bone : pose) bone.translation.z() += height_at(time);
    session.push({time, pose}, time / rate);
    while (const auto robot = session.pull(time / rate)) height = robot->qpos[2];
  }
  return height;
}

// The floor follows a jump of the world, but not a jump of the human, also with slow and fast
// clocks.
TEST(LiveFrames, FloorFollowsJumpsOfTheWorld) {
  const Plan plan = sample_plan("walk", Method::kFit);
  const double end = 2.0 * human_of(plan).rate.time_of(human_of(plan).frame_count);
  for (const double rate : {0.5, 1.0, 2.0}) {
    const double level = last_height(plan, rate, [](double) { return 0.0; });
    for (const double jump : {-0.3, 0.15, 0.3}) {
      const auto after = [&](double time) { return time < end - 6.0 * rate ? 0.0 : jump; };
      // Of a jump that is spread over several frames, a part remains for some seconds.
      const double most = 0.02 + 0.2 * std::abs(jump);
      EXPECT_NEAR(last_height(plan, rate, after), level, most) << rate << ", " << jump;
    }
    for (const double speed : {1.0, 1.5, 2.5}) {
      const auto hop = [&](double time) {
        const double air = time - (end - 2.0 * speed / 9.81 - 0.1);
        return std::max(0.0, speed * air - 0.5 * 9.81 * air * air);
      };
      EXPECT_NEAR(last_height(plan, rate, hop), level, 0.02) << rate << ", " << speed;
    }
  }
}

// The times of a session's robot frames, with a pause of the human after half of the clip.
std::vector<double> times_of(LiveSession& session, const HumanClip& human, double pause) {
  std::vector<double> times;
  const auto take = [&](double now) {
    while (const auto frame = session.pull(now)) times.push_back(frame->time);
  };
  double now = 0.0;
  for (int i = 0; i < human.frame_count; ++i) {
    now = human.rate.time_of(i) + (2 * i < human.frame_count ? 0.0 : pause);
    take(now - 2e-6);
    session.push({now, human.frame(i)}, now);
    take(now);
  }
  session.finish();
  take(now);
  return times;
}

// Also while the window fills and empties.
TEST(LiveLag, FramesTellTheTimesOfTheirPoses) {
  const Plan plan = sample_plan("wave", Method::kFit);
  const HumanClip human = human_of(plan);
  LiveSession session = session_of(plan, with_lag(human.rate.fps(), kLongLag));
  const std::vector<double> times = times_of(session, human, 0.0);
  ASSERT_EQ(static_cast<int>(times.size()), human.frame_count);
  for (int i = 0; i < human.frame_count; ++i) {
    EXPECT_NEAR(times[static_cast<std::size_t>(i)], human.rate.time_of(i), 1e-9) << i;
  }
}

TEST(LiveLag, TimesContinueAfterAPause) {
  const Plan plan = sample_plan("wave", Method::kFit);
  const HumanClip human = human_of(plan);
  LiveSession session = session_of(plan, with_lag(50.0, 0.2));
  const std::vector<double> times = times_of(session, human, 1.0);
  EXPECT_TRUE(std::ranges::is_sorted(times));
  EXPECT_NEAR(times.back(), human.rate.time_of(human.frame_count - 1) + 1.0, 0.02);
}

TEST(LiveFrames, AllocateNothing) {
  const Plan plan = sample_plan("walk", Method::kFit);
  LiveOptions options;
  options.fps = 50.0;
  LiveSession session = session_of(plan, options);
  const HumanClip human = human_of(plan);
  long before = 0;
  for (int i = 0; i < human.frame_count; ++i) {
    const HumanFrame frame{human.rate.time_of(i), human.frame(i)};
    // The first frame is solved from several starts.
    if (i == 10) before = allocations;
    session.push(frame, frame.time);
    while (session.pull(frame.time)) {
    }
  }
  EXPECT_EQ(allocations, before);
  EXPECT_GT(session.statistics().robot_frames, 100);
}

// New situations may allocate: the solver's lists of near shapes and limits grow.
TEST(LiveLag, AllocatesNothingAfterWarmUp) {
  const Plan plan = sample_plan("walk", Method::kFit);
  const HumanClip human = human_of(plan);
  for (const double lag_s : {0.0, 0.2, 1.5}) {
    LiveSession session = session_of(plan, with_lag(50.0, lag_s));
    // The clip is played forwards and backwards. The fitted clip discards its beginning after
    // twelve seconds, then every six.
    constexpr double kKnown = 45.0, kSeconds = 70.0;
    const int period = 2 * human.frame_count - 2;
    long before = -1;
    for (int i = 0; human.rate.time_of(i) < kSeconds; ++i) {
      const int place = i % period;
      const HumanFrame frame{human.rate.time_of(i), human.frame(std::min(place, period - place))};
      if (before < 0 && frame.time >= kKnown) before = allocations;
      session.push(frame, frame.time);
      while (session.pull(frame.time)) {
      }
    }
    EXPECT_EQ(allocations, before) << lag_s;
    EXPECT_GT(session.statistics().robot_frames, 3000) << lag_s;
    EXPECT_EQ(session.statistics().interruptions, 0) << lag_s;
  }
}

double figure(const QualityReport& report, const char* key) {
  const MetricValue* value = report.find(key);
  EXPECT_NE(value, nullptr) << key;
  return value == nullptr ? 0.0 : value->value;
}

QualityReport measured(const Plan& plan, const std::vector<std::vector<double>>& frames) {
  return value_of(evaluate(motion_of(plan, frames)));
}

TEST(LiveFrames, HoldFeetInPlaceAboveTheFloor) {
  const Plan plan = sample_plan("walk", Method::kFit);
  const HumanClip human = human_of(plan);
  LiveOptions options = plain_frames(plan.rate.fps());
  LiveSession plain = session_of(plan, options);
  options.limit_speeds = options.floor = options.hold_feet = true;
  LiveSession held = session_of(plan, options);
  const QualityReport without = measured(plan, streamed(plain, human));
  const QualityReport with = measured(plan, streamed(held, human));
  EXPECT_LT(figure(with, "stance_slip_mean"), 0.7 * figure(without, "stance_slip_mean"));
  EXPECT_LT(figure(with, "stance_drift_p95_cm"), 0.7 * figure(without, "stance_drift_p95_cm"));
  EXPECT_GT(figure(without, "stance_height_p50_cm"), 1.0);
  EXPECT_NEAR(figure(with, "stance_height_p50_cm"), 0.0, 0.1);
  EXPECT_LT(figure(with, "foot_pen_max_cm"), 0.01);
  EXPECT_EQ(figure(with, "speed_limit_pct"), 0.0);
}

TEST(LiveLag, LagBeyondTheClipLengthPassesTheGatesOfTheFit) {
  for (const char* name : {"walk", "squat", "turn_in_place", "wave", "get_up"}) {
    const Plan plan = sample_plan(name, Method::kFit);
    LiveSession session = session_of(plan, with_lag(plan.rate.fps(), kLongLag));
    const auto frames = streamed(session, human_of(plan));
    ASSERT_EQ(static_cast<int>(frames.size()), plan.clip->frame_count()) << name;
    const auto offline = value_of(solve(plan));
    const QualityReport live = measured(plan, frames), whole = evaluate(offline).value();
    for (std::size_t i = 0; i < whole.gates.size(); ++i) {
      if (!whole.gates[i].passed) continue;
      EXPECT_TRUE(live.gates[i].passed)
          << name << ": " << live.gates[i].metric << " is " << live.gates[i].value.value_or(-1.0)
          << ", of the whole clip " << whole.gates[i].value.value_or(-1.0);
    }
  }
}

TEST(LiveLag, IsSmootherThanSingleFrames) {
  const Plan plan = sample_plan("walk", Method::kFit);
  const HumanClip human = human_of(plan);
  LiveOptions options;
  options.fps = plan.rate.fps();
  LiveSession frames = session_of(plan, options);
  LiveSession lagging = session_of(plan, with_lag(plan.rate.fps(), 0.2));
  const QualityReport at_once = measured(plan, streamed(frames, human));
  const QualityReport later = measured(plan, streamed(lagging, human));
  EXPECT_TRUE(later.passed());
  for (const char* key : {"acc_rms", "root_jerk_mean", "stance_slip_mean", "self_1cm_pct"}) {
    EXPECT_LT(figure(later, key), 0.7 * figure(at_once, key)) << key;
  }
}

// A cost on changes of acceleration, without later frames, made the arms swing at their speed limits.
TEST(LiveLag, ShortLagsDoNotOscillate) {
  const Plan plan = sample_plan("walk", Method::kFit);
  const HumanClip human = human_of(plan);
  LiveSession lagging = session_of(plan, with_lag(plan.rate.fps(), 0.2));
  const QualityReport late = measured(plan, streamed(lagging, human));
  for (const double lag : {0.0, 0.04}) {
    LiveSession session = session_of(plan, with_lag(plan.rate.fps(), lag));
    const QualityReport early = measured(plan, streamed(session, human));
    EXPECT_LT(figure(early, "acc_rms"), 1.6 * figure(late, "acc_rms")) << lag;
    EXPECT_LT(figure(early, "limb_angle_deg"), figure(late, "limb_angle_deg") + 1.0) << lag;
  }
  // A window of one frame at a low rate is as long as two frames at 50.
  LiveSession slow = session_of(plan, with_lag(25.0, 0.0));
  LiveSession slow_late = session_of(plan, with_lag(25.0, 0.2));
  const auto acceleration = [&](LiveSession& session) {
    const auto frames = streamed(session, human);
    double sum = 0.0;
    for (std::size_t i = 2; i < frames.size(); ++i) {
      for (std::size_t j = 7; j < frames[i].size(); ++j) {
        const double change = frames[i][j] - 2.0 * frames[i - 1][j] + frames[i - 2][j];
        sum += change * change;
      }
    }
    return std::sqrt(sum / static_cast<double>(frames.size()));
  };
  EXPECT_LT(acceleration(slow), 1.6 * acceleration(slow_late));
}

TEST(Live, RejectsImpossibleOptions) {
  const Plan plan = sample_plan("wave", Method::kGmr);
  EXPECT_EQ(LiveSession::make(plan, with_lag(50.0, 0.2)).error().kind, ErrorKind::kUsage);
  LiveOptions options;
  options.fps = 0.0;
  EXPECT_EQ(LiveSession::make(plan, options).error().kind, ErrorKind::kUsage);
  Plan empty = plan;
  empty.clip = nullptr;
  EXPECT_EQ(LiveSession::make(empty).error().kind, ErrorKind::kUsage);
}

// Weights whose squares overflow: frames keep the result of the first stage and are counted.
TEST(LiveLag, CountsStepsThatAreNotFinite) {
  Plan plan = sample_plan("wave", Method::kFit);
  LiveSession sound = session_of(plan, with_lag(plan.rate.fps(), 0.2));
  streamed(sound, human_of(plan));
  EXPECT_EQ(sound.statistics().failed_steps, 0);
  plan.fit.smoothness_leg = 1e200;
  LiveSession failing = session_of(plan, with_lag(plan.rate.fps(), 0.2));
  const auto frames = streamed(failing, human_of(plan));
  EXPECT_GT(failing.statistics().failed_steps, 0);
  EXPECT_EQ(static_cast<int>(frames.size()), plan.clip->frame_count());
  for (const auto& frame : frames) {
    for (const double value : frame) EXPECT_TRUE(std::isfinite(value));
  }
}

}  // namespace
}  // namespace retarget
