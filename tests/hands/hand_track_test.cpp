// Hands of a whole clip: tracked and relaxed fingers, bounds on the printed values, coupled joints.

#include "solve/hands/hand_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robot/shipped_robots.h"
#include "support/finger_clip.h"
#include "support/hand_robots.h"

namespace retarget {
namespace {

constexpr int kFrames = 90;

// The left hand opens, closes and pinches; the right one is still.
FingerClip moving_clip() {
  FingerClip source(kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame < 20) continue;
    if (frame < 50) {
      source.make_fist(frame, 0);
    } else {
      source.pinch(frame, 0, Finger::kIndex);
    }
  }
  return source;
}

struct Tracked {
  std::shared_ptr<const Robot> robot;
  RobotHands hands;
  RobotClip clip;

  Tracked(std::shared_ptr<const Robot> of, const FingerClip& source, HandsRule rule)
      : robot(of), hands(find_hands(*of)), clip(of, source.clip().rate(), kFrames) {
    const FrameRange all{0, kFrames};
    const SourceHands followed = followed_hands(source.clip(), source.map(), hands, rule, all);
    const HandTrack track(source.clip(), followed, *robot, hands, robot->model_limits());
    for (int frame = 0; frame < kFrames; ++frame) track.write(frame, clip.qpos(frame));
  }
  [[nodiscard]] double at(int frame, const std::string& joint) const {
    return clip.qpos(frame)[robot->joints()[*robot->find_joint(joint)].qpos_address];
  }
};

TEST(HandTrackTest, OneHandFollowsAndTheOtherIsRelaxed) {
  const FingerClip source = moving_clip();
  const Tracked g1(load_shipped("unitree_g1_with_hands"), source, HandsRule::kFollow);
  const Tracked relaxed(load_shipped("unitree_g1_with_hands"), source, HandsRule::kRelaxed);
  EXPECT_LT(std::abs(g1.at(0, "left_hand_index_0_joint")), 0.2) << "open";
  EXPECT_LT(g1.at(35, "left_hand_index_0_joint"), -1.2) << "a fist";
  for (const int frame : {0, 35, 80}) {
    for (const char* const joint : {"right_hand_index_0_joint", "right_hand_thumb_0_joint"}) {
      EXPECT_EQ(g1.at(frame, joint), relaxed.at(0, joint));
    }
    EXPECT_EQ(relaxed.at(frame, "left_hand_index_0_joint"),
              relaxed.at(0, "left_hand_index_0_joint"));
    // Mirror images of each other.
    EXPECT_NEAR(relaxed.at(frame, "left_hand_index_0_joint"),
                -relaxed.at(frame, "right_hand_index_0_joint"), 1e-6);
  }
  // Other joints do not change.
  EXPECT_EQ(g1.at(35, "left_elbow_joint"), 0.0);
}

TEST(HandTrackTest, RangesAndSpeedsHoldAsPrinted) {
  for (const bool of_six_motors : {false, true}) {
    const auto robot =
        of_six_motors ? robot_from_text(six_motor_hands()) : load_shipped("unitree_g1_with_hands");
    const Tracked tracked(robot, moving_clip(), HandsRule::kFollow);
    const double frame_time = 1.0 / 30.0;
    for (const auto& hand : tracked.hands) {
      for (const HandJoint& joint : hand->joints) {
        const int at = robot->joints()[joint.joint].qpos_address;
        const auto printed = [&](int frame) {
          return std::round(tracked.clip.qpos(frame)[at] * 1e6) / 1e6;
        };
        for (int frame = 0; frame < kFrames; ++frame) {
          EXPECT_GE(printed(frame), robot->model_limits().lower[joint.joint]);
          EXPECT_LE(printed(frame), robot->model_limits().upper[joint.joint]);
          if (frame == 0) continue;
          const double step = std::abs(printed(frame) - printed(frame - 1));
          EXPECT_LE(step, std::min(14.4 * frame_time, 0.48)) << robot->joints()[joint.joint].name;
        }
      }
    }
  }
}

TEST(HandTrackTest, CoupledJointsFollow) {
  const auto robot = robot_from_text(six_motor_hands());
  const Tracked tracked(robot, moving_clip(), HandsRule::kFollow);
  double most = 0.0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double leader = tracked.at(frame, "left_index_proximal");
    most = std::max(most, leader);
    EXPECT_DOUBLE_EQ(tracked.at(frame, "left_index_intermediate"), 1.1 * leader - 0.04);
  }
  EXPECT_GT(most, 1.2);
}

// A default curl of a skeleton, such as SMPL's mean hand.
void curl(FingerClip& source, int frame, std::size_t side) {
  for (const Finger finger : kFingers) {
    if (finger != Finger::kThumb) source.bend(frame, side, finger, {0.55, 0.70, 0.40});
  }
}

bool follows(const FingerClip& source, HandsRule rule, std::size_t side) {
  static const RobotHands kHands = find_hands(*load_shipped("unitree_g1_with_hands"));
  const FrameRange all{0, source.clip().frame_count()};
  return followed_hands(source.clip(), source.map(), kHands, rule, all)[side].has_value();
}

TEST(HandTrackTest, HandsAtRestAndDefaultCurlsAreRelaxed) {
  FingerClip still(kFrames);
  for (int frame = 0; frame < kFrames; ++frame) curl(still, frame, 0);
  for (const std::size_t side : {0U, 1U}) EXPECT_FALSE(follows(still, HandsRule::kAuto, side));
  EXPECT_TRUE(follows(still, HandsRule::kFollow, 0)) << "on request, any pose is followed";
  EXPECT_FALSE(follows(still, HandsRule::kFollow, 1)) << "all rotations are zero";
  EXPECT_FALSE(follows(still, HandsRule::kRelaxed, 0));
  const auto robot = load_shipped("unitree_g1_with_hands");
  const Tracked a(robot, still, HandsRule::kAuto);
  const Tracked b(robot, still, HandsRule::kRelaxed);
  for (int frame = 0; frame < kFrames; ++frame) {
    EXPECT_TRUE(std::ranges::equal(a.clip.qpos(frame), b.clip.qpos(frame)));
  }
  EXPECT_EQ(hands_rule(HandsRule::kAuto, Method::kFit), HandsRule::kAuto);
  EXPECT_EQ(hands_rule(HandsRule::kAuto, Method::kGmr), HandsRule::kOff);
  EXPECT_EQ(hands_rule(HandsRule::kFollow, Method::kGmr), HandsRule::kFollow);
}

TEST(HandTrackTest, HeldFistsAndPointingHandsAreFollowed) {
  FingerClip held(kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    held.make_fist(frame, 0);
    held.make_fist(frame, 1);
    held.bend(frame, 1, Finger::kIndex, {0.0, 0.0, 0.0});
  }
  EXPECT_TRUE(follows(held, HandsRule::kAuto, 0));
  EXPECT_TRUE(follows(held, HandsRule::kAuto, 1));
  const Tracked g1(load_shipped("unitree_g1_with_hands"), held, HandsRule::kAuto);
  EXPECT_LT(g1.at(45, "left_hand_index_0_joint"), -1.2) << "a fist";
  EXPECT_LT(std::abs(g1.at(45, "right_hand_index_0_joint")), 0.3) << "points";
  EXPECT_GT(g1.at(45, "right_hand_middle_0_joint"), 1.2);
}

// The left hand closes and opens in 2 s; the thumb turns by `base` and bends by `outer` of the angle
// by which the fingers bend.
Clip closing_clip(int fps, double base, double outer) {
  const int frames = 2 * fps + 1;
  FingerClip source(frames);
  Clip clip(source.clip().shared_skeleton(), FrameRate{fps, 1}, frames);
  for (int frame = 0; frame < frames; ++frame) {
    const double by = 0.25 * std::numbers::pi * (1.0 - std::cos(std::numbers::pi * frame / fps));
    for (const Finger finger : kFingers) source.bend(frame, 0, finger, {by, by, by});
    for (int bone = 0; bone < 3; ++bone) {
      const double turn = by * (bone == 0 ? base : outer);
      source.turn(frame, 0, Finger::kThumb, bone, {0.0, turn, 0.0});
    }
    copy_frame(source.clip(), frame, clip, frame);
  }
  return clip;
}

// Ten poses per second.
std::vector<std::vector<double>> hand_poses(const Clip& clip, double& fastest) {
  static const auto kRobot = load_shipped("unitree_g1_with_hands");
  const RobotHands hands = find_hands(*kRobot);
  const SourceHands followed =
      followed_hands(clip, FingerClip(1).map(), hands, HandsRule::kAuto, {0, clip.frame_count()});
  const HandTrack track(clip, followed, *kRobot, hands, kRobot->model_limits());
  const int fps = static_cast<int>(std::lround(clip.rate().fps()));
  std::vector<std::vector<double>> poses;
  std::vector<double> qpos = kRobot->zero_configuration(), before;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    before = qpos;
    track.write(frame, qpos);
    for (std::size_t i = 0; frame > 0 && i < qpos.size(); ++i) {
      fastest = std::max(fastest, std::abs(qpos[i] - before[i]) * fps);
    }
    if (frame % (fps / 10) == 0) poses.push_back(qpos);
  }
  return poses;
}

TEST(HandTrackTest, ClosingHandsDoNotSnapAndDoNotDependOnTheFrameRate) {
  for (const auto& [base, outer] : {std::pair(0.3, 0.7), {0.0, 0.7}, {0.6, 0.7}, {0.0, 0.5}}) {
    double fastest = 0.0;
    const auto exact = hand_poses(closing_clip(120, base, outer), fastest);
    for (const int fps : {20, 30, 60}) {
      const auto poses = hand_poses(closing_clip(fps, base, outer), fastest);
      ASSERT_EQ(poses.size(), exact.size());
      double apart = 0.0;
      for (std::size_t k = 0; k < poses.size(); ++k) {
        for (std::size_t i = 0; i < poses[k].size(); ++i) {
          apart = std::max(apart, std::abs(poses[k][i] - exact[k][i]));
        }
      }
      EXPECT_LT(apart, 0.25) << fps << " fps, " << base << ", " << outer;
    }
    EXPECT_LT(fastest, 3.0 * std::numbers::pi) << base << ", " << outer;
  }
}

TEST(HandTrackTest, PinchesOfTheHumanCloseOnTheRobot) {
  const FingerClip source = moving_clip();
  for (const bool of_six_motors : {false, true}) {
    const auto robot =
        of_six_motors ? robot_from_text(six_motor_hands()) : load_shipped("unitree_g1_with_hands");
    const Tracked tracked(robot, source, HandsRule::kFollow);
    const HandErrors errors = measure_hands(source.clip(), source.map(), tracked.clip);
    ASSERT_EQ(errors.touching_gaps.size(), 40U)
        << "one finger touches the thumb in frames 50 to 89";
    // The previous fist opens at the joints' maximum speed.
    const auto open =
        std::ranges::count_if(errors.touching_gaps, [](double g) { return g > 0.005; });
    EXPECT_LT(open, 10);
    EXPECT_LT(*std::max_element(errors.touching_gaps.begin() + 10, errors.touching_gaps.end()),
              0.005);
    double sum = 0.0;
    for (const double angle : errors.angles) sum += angle;
    EXPECT_LT(sum / static_cast<double>(errors.angles.size()), 0.3);
  }
}

TEST(HandTrackTest, IsDeterministic) {
  const auto robot = robot_from_text(six_motor_hands());
  const Tracked a(robot, moving_clip(), HandsRule::kFollow);
  const Tracked b(robot, moving_clip(), HandsRule::kFollow);
  for (int frame = 0; frame < kFrames; ++frame) {
    EXPECT_TRUE(std::ranges::equal(a.clip.qpos(frame), b.clip.qpos(frame)));
  }
}

}  // namespace
}  // namespace retarget
