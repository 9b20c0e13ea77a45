// Sender clocks: rates, steps, changing delays, bursts. The position of the robot measures the time
// that it follows, because the human walks at an even pace in true time.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "live/live_sample.h"
#include "live/session/sender_clock.h"

namespace retarget {
namespace {

// Speed of the human, m/s: slow enough that resume limits do not affect the measurement.
constexpr double kPace = 0.05;

const Plan& stander() {
  static const Plan plan = sample_plan("walk", Method::kGmr);
  return plan;
}

// One pose that is translated.
HumanPose carried(double time, double pace) {
  static const HumanClip human = human_of(stander());
  HumanPose pose = human.frame(0);
  for (const Bone bone : kAllBones) pose[bone].translation.x() += pace * time;
  return pose;
}

struct Shown {
  double due, x;
  LiveState state;
};

// A stream in true time, and the robot's response.
class ClockRun {
 public:
  explicit ClockRun(double fps = 50.0, double human_pace = kPace)
      : session(LiveSession::make(stander(), options(fps)).value()), pace(human_pace) {}

  static LiveOptions options(double fps) {
    LiveOptions made;
    made.fps = fps;
    made.floor = made.hold_feet = false;
    return made;
  }
  // A frame of a true time.
  void frame(double time, double stamp, double arrival) {
    until(arrival);
    session.push({stamp, carried(time, pace)}, arrival);
    take(arrival);
  }
  void until(double time) { take(time - 1e-6); }
  void take(double now) {
    while (const auto frame = session.pull(now)) {
      shown.push_back({frame->due, frame->qpos[0], frame->state});
    }
  }
  // Age of the displayed human pose at a time, from the robot's distance and the human's pace.
  [[nodiscard]] double age(std::size_t i) const {
    return shown[i].due - (shown[i].x - shown.front().x) / (kPace * scale());
  }
  // Ratio of the robot's distance to the human's, from a stream without faults.
  static double scale() {
    static const double found = [] {
      ClockRun run;
      for (int i = 0; i <= 100; ++i) run.frame(i / 50.0, i / 50.0, i / 50.0);
      return (run.shown.back().x - run.shown.front().x) / (kPace * 2.0);
    }();
    return found;
  }
  // Expects that the robot follows in all frames due at or after `from`, with less delay than
  // `latest`.
  void expect_follows(double from, double latest, const std::string& what) const {
    int seen = 0;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      if (shown[i].due < from) continue;
      ++seen;
      ASSERT_EQ(shown[i].state, LiveState::kFollowing) << what << " at " << shown[i].due;
      ASSERT_LT(age(i), latest) << what << " at " << shown[i].due;
      ASSERT_GT(age(i), -0.02) << what << " at " << shown[i].due;
    }
    EXPECT_GT(seen, 20) << what;
  }
  void expect_even(const std::string& what, double fps = 50.0) const {
    std::size_t first = 0;
    for (std::size_t i = 1; i < shown.size(); ++i) {
      ASSERT_LE(shown[i].due - shown[i - 1].due, 1.55 / fps) << what << " at " << shown[i].due;
      while (shown[first].due <= shown[i].due - 1.0) ++first;
      ASSERT_LE(i - first + 1, fps + 2) << what << " at " << shown[i].due;
    }
  }

  // Expects that the root reaches speeds above the one to resume with gradually, in all frames due
  // at or after `from`.
  void expect_gentle(double from, const std::string& what, double fps = 50.0) const {
    constexpr double kResumes = 1.0, kMore = 0.5;  // m/s
    constexpr std::size_t kEarlier = 3;            // frames
    std::vector<double> speeds = {0.0};
    for (std::size_t i = 1; i < shown.size(); ++i) {
      const double seconds = std::min(1.0 / fps, shown[i].due - shown[i - 1].due);
      speeds.push_back(std::abs(shown[i].x - shown[i - 1].x) / seconds);
      if (shown[i].due < from || i < kEarlier) continue;
      const double before = *std::max_element(speeds.end() - 1 - kEarlier, speeds.end() - 1);
      ASSERT_LE(speeds.back(), std::max(kResumes, before) + kMore)
          << what << " at " << shown[i].due;
    }
  }

  LiveSession session;
  double pace;  // m/s, of the human
  std::vector<Shown> shown;
};

TEST(LiveClocks, AnyRateIsFollowed) {
  for (const double fps : {30.0, 50.0, 60.0, 120.0}) {
    for (const double rate : {0.5, 0.75, 0.9, 0.95, 0.97, 1.0, 1.03, 1.1, 1.5, 2.0}) {
      for (const double jitter : {0.0, 0.004}) {
        ClockRun run;
        std::mt19937 random(5);
        std::uniform_real_distribution<double> late(0.0, jitter);
        for (int i = 0; i <= 4.0 * fps; ++i) {
          run.frame(i / fps, rate * i / fps + 7.0, i / fps + (jitter > 0.0 ? late(random) : 0.0));
        }
        const std::string what = "rate " + std::to_string(rate) + ", " + std::to_string(fps) +
                                 " fps, jitter " + std::to_string(jitter);
        run.expect_follows(0.4, 0.045 + 1.0 / fps, what);
        run.expect_even(what);
        EXPECT_NEAR(run.session.statistics().sender_rate, rate, jitter > 0.0 ? 0.03 : 0.01) << what;
        EXPECT_EQ(run.session.statistics().held, 0) << what;
        EXPECT_EQ(run.session.statistics().interruptions, 0) << what;
      }
    }
  }
}

TEST(LiveClocks, StepsAreFollowedWithinTwoFifthsOfASecond) {
  for (const double fps : {30.0, 50.0, 100.0}) {
    for (const double size : {0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 3.0, 10.0}) {
      for (const double sign : {-1.0, 1.0}) {
        for (const double rate : {0.5, 1.0, 2.0}) {
          const double step = sign * size;
          ClockRun run;
          for (int i = 0; i <= 4.0 * fps; ++i) {
            const double time = i / fps;
            run.frame(time, rate * time + (time > 2.0 ? step : 0.0), time + 0.002 * (i % 3));
          }
          const std::string what = "step " + std::to_string(step) + ", rate " +
                                   std::to_string(rate) + ", " + std::to_string(fps) + " fps";
          run.expect_even(what);
          run.expect_follows(2.4 + 1.0 / fps, 0.06 + 1.0 / fps, what);
        }
      }
    }
  }
}

TEST(LiveClocks, ADelayThatChangesIsFollowedWithinTwoFifthsOfASecond) {
  for (const double more : {0.05, 0.15, 0.3, 1.0, 3.0}) {
    ClockRun run;
    for (int i = 0; i <= 150; ++i) {
      const double time = i / 30.0;
      run.frame(time, time, time + (time > 2.0 ? more : 0.0));
    }
    const std::string what = "later by " + std::to_string(more);
    run.expect_even(what);
    run.expect_follows(2.0 + more + 0.45, more + 0.1, what);
  }
}

// After a step of the clock or of the delay the human may be elsewhere, whatever the stamps say.
TEST(LiveClocks, StepsAndShorterDelaysAreResumedGently) {
  constexpr double kWalks = 0.8;  // m/s
  for (const double fps : {30.0, 50.0, 100.0}) {
    for (const double size : {0.1, 0.12, 0.15, 0.2, 0.3, 0.5, 1.0}) {
      for (const double rate : {0.5, 1.0, 2.0}) {
        ClockRun back(50.0, kWalks), forth(50.0, kWalks), sooner(50.0, kWalks);
        std::vector<std::pair<double, double>> arrivals;  // Arrival and frame time.
        for (int i = 0; i <= 4.0 * fps; ++i) {
          const double time = i / fps, step = time > 2.0 ? size : 0.0;
          back.frame(time, rate * time - step, time);
          forth.frame(time, rate * time + step, time);
          arrivals.emplace_back(time + size - step, time);
        }
        std::ranges::sort(arrivals);
        for (const auto& [arrival, time] : arrivals) sooner.frame(time, rate * time, arrival);
        const std::string what = std::to_string(size) + ", rate " + std::to_string(rate) + ", " +
                                 std::to_string(fps) + " fps";
        back.expect_gentle(1.9, "set back by " + what);
        forth.expect_gentle(1.9, "set forward by " + what);
        sooner.expect_gentle(1.9, "sooner by " + what);
      }
    }
  }
}

TEST(LiveClocks, ARateThatChangesIsFollowed) {
  for (const double rate : {0.5, 0.7, 1.4, 2.0}) {
    ClockRun run;
    double stamp = 0.0;
    for (int i = 0; i <= 300; ++i) {
      const double time = i / 50.0;
      stamp += (time > 3.0 ? rate : 1.0) / 50.0;
      run.frame(time, stamp, time + 0.001 * (i % 4));
    }
    const std::string what = "rate " + std::to_string(rate);
    run.expect_even(what);
    run.expect_follows(3.6, 0.09, what);
    EXPECT_NEAR(run.session.statistics().sender_rate, rate, 0.02);
  }
}

TEST(LiveClocks, DelayedFramesAreNotCaughtUp) {
  for (const double held : {0.2, 0.4, 1.0}) {
    ClockRun run;
    for (int i = 0; i <= 150; ++i) {
      const double time = i / 30.0;
      run.frame(time, time, time > 2.0 && time < 2.0 + held ? 2.0 + held : time);
    }
    const std::string what = "held up for " + std::to_string(held);
    run.expect_even(what);
    run.expect_follows(2.0 + held + 0.4, 0.1, what);
  }
}

TEST(LiveClocks, ImplausibleTimestampsUseTheArrivalTime) {
  ClockRun run;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> anything(-1e6, 1e6);
  for (int i = 0; i <= 300; ++i) run.frame(i / 50.0, anything(random), i / 50.0);
  EXPECT_GT(std::ranges::count(run.shown, LiveState::kFollowing, &Shown::state), 250);
  run.expect_even("random stamps");
}

TEST(LiveClocks, FollowsARestartedStream) {
  ClockRun run;
  for (int i = 0; i <= 90; ++i) run.frame(i / 30.0, i / 30.0, i / 30.0);
  for (int i = 91; i <= 180; ++i) run.frame(i / 30.0, (i - 91) / 30.0, i / 30.0);
  run.expect_even("replay");
  run.expect_follows(3.45, 0.1, "replay");
}

TEST(SkewLine, FindsOffsetAndRateBelowJitter) {
  std::mt19937 random(3);
  std::exponential_distribution<double> late(1.0 / 0.005);
  for (const double rate : {0.5, 0.99, 1.0, 1.01, 2.0}) {
    SkewLine line;
    for (int i = 0; i < 600; ++i) {
      const double sent = i / 60.0;
      line.add(100.0 + rate * sent, 3.0 + sent + late(random));
    }
    EXPECT_NEAR(line.rate(), rate, 0.001 * rate) << rate;
    EXPECT_NEAR(line.arrival_of(100.0 + rate * 10.0), 13.0, 0.003) << rate;
    EXPECT_NEAR(line.spread(), 0.002, 0.003) << rate;
  }
}

}  // namespace
}  // namespace retarget
