// A robot that holds its pose does not move: it brakes within its limits and then rests.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "live/live_sample.h"

namespace retarget {
namespace {

constexpr double kHoldingFps = 50.0;

HumanPose displaced(HumanPose pose, const Eigen::Vector3d& by) {
  for (const Bone bone : kAllBones) pose[bone].translation += by;
  return pose;
}

struct HeldFrame {
  LiveState state;
  std::vector<double> qpos;
};

// Lets time pass without frames.
void wait_without_frames(LiveSession& session, double from, double until,
                         std::vector<HeldFrame>& frames) {
  for (double now = from; now < until; now += 0.001) {
    while (const auto frame = session.pull(now)) {
      frames.push_back({frame->state, {frame->qpos.begin(), frame->qpos.end()}});
    }
  }
}

double root_distance(const HeldFrame& a, const HeldFrame& b) {
  return (Eigen::Map<const Eigen::Vector3d>(a.qpos.data()) -
          Eigen::Map<const Eigen::Vector3d>(b.qpos.data()))
      .norm();
}

LiveOptions holding_options(LiveMode mode) {
  LiveOptions options;
  options.fps = kHoldingFps;
  options.mode = mode;
  return options;
}

// Tracking jumps away for four frames, then the stream stalls: the robot is on its way to a far target.
std::vector<HeldFrame> frames_after_a_jump(const LiveOptions& options) {
  LiveSession session = LiveSession::make(walk_plan(), options).value();
  std::vector<HeldFrame> frames;
  const HumanClip& human = walking_human();
  for (int i = 0; i < 104; ++i) {
    const double now = i / 30.0;
    const Eigen::Vector3d by = i < 100 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(12.0, 0.0, 5.0);
    session.push({now, displaced(human.frame(i), by)}, now);
    wait_without_frames(session, now, now + 1.0 / 30.0, frames);
  }
  wait_without_frames(session, 104 / 30.0, 5.2, frames);
  return frames;
}

TEST(LiveHolding, ARobotOnItsWayToAFarTargetStops) {
  for (const LiveMode mode : {LiveMode::kFrame, LiveMode::kLag}) {
    const LiveOptions options = holding_options(mode);
    const auto frames = frames_after_a_jump(options);
    // A window also fills again after the jump.
    const auto first =
        std::ranges::find_if(frames.rbegin(), frames.rend(), [](const HeldFrame& frame) {
          return frame.state != LiveState::kHolding;
        }).base();
    ASSERT_GT(std::distance(first, frames.end()), 40);
    // From the full root speed, it stops within 0.1 s.
    constexpr int kBrakes = 6;  // frames
    EXPECT_LT(root_distance(*first, frames.back()),
              std::pow(options.limits.root_speed, 2) / options.limits.root_acceleration);
    for (auto frame = first + kBrakes; frame != frames.end(); ++frame) {
      ASSERT_EQ(frame->qpos, first[kBrakes].qpos) << std::distance(first, frame);
    }
  }
}

TEST(LiveHolding, BrakesWithinTheLimits) {
  LiveOptions options = holding_options(LiveMode::kFrame);
  options.limits.root_acceleration = 4.0;
  options.limits.joint_acceleration = 20.0;
  const auto frames = frames_after_a_jump(options);
  const auto velocity = [&](std::size_t i, std::size_t value) {
    return kHoldingFps * (frames[i].qpos[value] - frames[i - 1].qpos[value]);
  };
  double fastest = 0.0;
  for (std::size_t i = 2; i < frames.size(); ++i) {
    if (frames[i].state != LiveState::kHolding) continue;
    fastest = std::max(fastest, kHoldingFps * root_distance(frames[i], frames[i - 1]));
    for (std::size_t value = 0; value < frames[i].qpos.size(); ++value) {
      if (value >= 3 && value < 7) continue;  // The quaternion.
      const double most =
          value < 3 ? options.limits.root_acceleration : options.limits.joint_acceleration;
      ASSERT_LE(std::abs(velocity(i, value) - velocity(i - 1, value)), most / kHoldingFps + 1e-6)
          << "frame " << i << ", value " << value;
    }
  }
  EXPECT_GT(fastest, 0.2) << "the robot was moving";
  EXPECT_EQ(frames.back().qpos, frames[frames.size() - 2].qpos);
}

// A window that fills again after a gap delays the robot, which meanwhile holds its pose.
TEST(LiveHolding, AFillingWindowMovesNothing) {
  LiveOptions options = holding_options(LiveMode::kLag);
  options.lag_s = 0.5;
  LiveSession session = LiveSession::make(walk_plan(), options).value();
  const HumanClip& human = walking_human();
  std::vector<HeldFrame> frames;
  for (int i = 0; i < 200; ++i) {
    const double now = i / 30.0 + (i < 60 ? 0.0 : 1.0);
    session.push({now, human.frame(i)}, now);
    wait_without_frames(session, now, now + (i == 59 ? 1.0 : 1.0 / 30.0), frames);
  }
  int held = 0, moved = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (frames[i].state != LiveState::kHolding) continue;
    ++held;
    moved += frames[i].qpos == frames[i - 1].qpos ? 0 : 1;
  }
  EXPECT_GT(held, 50);
  EXPECT_LT(moved, 10);
  EXPECT_EQ(frames.back().state, LiveState::kFollowing);
}

TEST(LiveTimes, GapsOfArrivalTimesAreNotLostFrames) {
  for (const bool stamped : {true, false}) {
    LiveSession session = LiveSession::make(walk_plan()).value();
    int sent = 0;
    for (int i = 0; i < 200; ++i) {
      if (i > 20 && i % 7 == 0) continue;
      const double now = i / 60.0;
      HumanFrame frame{stamped ? now : std::numeric_limits<double>::quiet_NaN(),
                       walking_human().frame(i)};
      session.push(frame, now);
      ++sent;
      while (session.pull(now)) {
      }
    }
    EXPECT_EQ(session.statistics().received, sent);
    if (stamped) {
      EXPECT_GT(session.statistics().lost, 15);
    } else {
      EXPECT_EQ(session.statistics().lost, 0);
    }
  }
}

TEST(LiveTimes, TimesThatAreNoneChangeNothing) {
  LiveSession session = LiveSession::make(walk_plan()).value();
  const HumanPose pose = walking_human().frame(0);
  session.push({0.0, pose}, 0.0);
  ASSERT_TRUE(session.pull(0.0));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double none : {std::nan(""), kInfinity, -kInfinity, 1e300}) {
    EXPECT_FALSE(session.pull(none)) << none;
    session.push({0.1, pose}, none);
    session.skip_to(none);
  }
  EXPECT_EQ(session.statistics().bad, 4);
  EXPECT_EQ(session.statistics().missed, 0);
  // A jump that the caller skips costs no time, however long it is.
  session.skip_to(1e9);
  EXPECT_NEAR(static_cast<double>(session.statistics().missed), 50e9, 2.0);
  int frames = 0;
  while (session.pull(1e9)) ++frames;
  EXPECT_LE(frames, 2);
}

}  // namespace
}  // namespace retarget
