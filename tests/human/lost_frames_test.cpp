#include "human/gait/repeated_frames.h"
#include "human/gait/track_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "human/bending_chain.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using namespace track_test;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(LostFrames, CompleteClipsDoNotChange) {
  const Clip clip = bending_chain();
  Clip bridged = clip;
  EXPECT_THAT(bridge_lost_joints(bridged, kWhole), IsEmpty());
  EXPECT_EQ(bridge_frozen_frames(bridged, kWhole), 0);
  EXPECT_TRUE(same_clips(clip, bridged));
}

TEST(LostFrames, InterpolatesALostJoint) {
  const Clip clip = bending_chain();
  Clip lost = clip;
  for (const int frame : {20, 21, 22, 40}) lost.rotations(frame)[2] = Quaterniond::Identity();
  EXPECT_THAT(bridge_lost_joints(lost, kWhole), ElementsAre("joint2 was lost in 4 frames"));
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto& found = std::as_const(lost).rotations(frame)[2];
    EXPECT_LT(found.angularDistance(clip.rotations(frame)[2]), 0.03) << frame;
  }
}

TEST(LostFrames, AcceptsAZeroPose) {
  Clip clip = bending_chain();
  for (auto& rotation : clip.rotations(30)) rotation = Quaterniond::Identity();
  const Clip before = clip;
  EXPECT_THAT(bridge_lost_joints(clip, kWhole), IsEmpty());
  EXPECT_TRUE(same_clips(before, clip));
}

TEST(LostFrames, AcceptsAJointThatPassesZero) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    clip.rotations(frame)[2] = exp_so3(Vector3d(0.05 * (frame - 30), 0.0, 0.0));
  }
  EXPECT_THAT(bridge_lost_joints(clip, kWhole), IsEmpty());
}

TEST(LostFrames, BridgesASmallJumpOfASlowJoint) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    clip.rotations(frame)[2] = exp_so3(Vector3d(0.15 + 0.05 * std::sin(0.15 * frame), 0.0, 0.0));
  }
  Clip lost = clip;
  for (const int frame : {20, 21, 40, 42}) lost.rotations(frame)[2] = Quaterniond::Identity();
  EXPECT_THAT(bridge_lost_joints(lost, kWhole), ElementsAre("joint2 was lost in 4 frames"));
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto& found = std::as_const(lost).rotations(frame)[2];
    EXPECT_LT(found.angularDistance(clip.rotations(frame)[2]), 0.01) << frame;
  }
}

// A knee is straight for a moment.
TEST(LostFrames, AcceptsAJointThatStopsAtZero) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    const double bend = std::max(0.0, 0.6 * std::sin(0.4 * frame));
    clip.rotations(frame)[2] = exp_so3(Vector3d(bend, 0.0, 0.0));
    clip.rotations(frame)[3] = exp_so3(Vector3d(0.05 * std::abs(frame - 30), 0.0, 0.0));
  }
  EXPECT_THAT(bridge_lost_joints(clip, kWhole), IsEmpty());
}

TEST(LostFrames, InterpolatesFrozenFrames) {
  const Clip clip = bending_chain();
  Clip frozen = clip;
  for (int frame = 21; frame < 27; ++frame) copy_frame(clip, 20, frozen, frame);
  EXPECT_EQ(bridge_frozen_frames(frozen, kWhole), 6);
  for (int frame = 20; frame < 28; ++frame) {
    EXPECT_NEAR(std::as_const(frozen).translations(frame)[0].x(), 0.02 * frame, 1e-9);
  }
}

// Interpolation would invent a movement: the joints turn back meanwhile. After 42 frames they are
// where they were, but the root is not.
TEST(LostFrames, KeepsAndNamesLongFreezes) {
  const Clip clip = bending_chain();
  EXPECT_THAT(kept_freezes(clip, kWhole, 1.0), IsEmpty());
  for (const FrameRange freeze : {FrameRange{15, 45}, FrameRange{10, 50}}) {
    Clip frozen = clip;
    for (int i = freeze.begin; i < freeze.end; ++i) copy_frame(clip, freeze.begin, frozen, i);
    EXPECT_THAT(kept_freezes(frozen, kWhole, 1.0), ElementsAre(freeze));
    const Clip before = frozen;
    EXPECT_EQ(bridge_frozen_frames(frozen, kWhole), 0);
    EXPECT_TRUE(same_clips(before, frozen));
  }
}

// The movement continues where it stopped, and short freezes are interpolated.
TEST(LostFrames, DoesNotNamePausesAndShortFreezes) {
  const Clip clip = bending_chain();
  Clip resting = clip, frozen = clip;
  for (int frame = 21; frame < 37; ++frame) copy_frame(clip, 20, resting, frame);
  for (int frame = 37; frame < kFrames; ++frame) copy_frame(clip, frame - 16, resting, frame);
  EXPECT_THAT(kept_freezes(resting, kWhole, 1.0), IsEmpty());
  for (int frame = 21; frame < 27; ++frame) copy_frame(clip, 20, frozen, frame);
  EXPECT_THAT(kept_freezes(frozen, kWhole, 1.0), IsEmpty());
}

// A detector repeats its last pose until the body is there again, on its way back.
TEST(LostFrames, NamesFreezesOfABodyThatComesBack) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    const Vector3d turn(1.0 + 0.02 * std::abs(frame - 30), 0.0, 0.0);
    for (auto& rotation : clip.rotations(frame)) rotation = exp_so3(turn);
    clip.translations(frame)[0].setZero();
  }
  EXPECT_THAT(kept_freezes(clip, kWhole, 1.0), IsEmpty());
  const Clip whole = clip;
  for (int frame = 16; frame < 45; ++frame) copy_frame(whole, 15, clip, frame);
  EXPECT_THAT(kept_freezes(clip, kWhole, 1.0), ElementsAre(FrameRange{15, 46}));
}

// All joints together turn by about 4 rad into the zero pose and out of it.
void lose_body(Clip& clip, FrameRange frames, bool with_root) {
  for (int frame = frames.begin; frame < frames.end; ++frame) {
    for (auto& rotation : clip.rotations(frame)) rotation = Quaterniond::Identity();
    if (with_root) clip.translations(frame)[0].setZero();
  }
}

// The first zero frame is not an anchor of an interpolation.
TEST(LostFrames, InterpolatesAZeroPoseWithinAMovement) {
  const Clip clip = bending_chain();
  for (const bool with_root : {true, false}) {
    Clip lost = clip;
    lose_body(lost, {20, 25}, with_root);
    EXPECT_THAT(kept_freezes(lost, kWhole, 1.0), IsEmpty());
    EXPECT_EQ(bridge_lost_frames(lost, kWhole), 5);
    EXPECT_EQ(bridge_frozen_frames(lost, kWhole), 0);
    for (int frame = 0; frame < kFrames; ++frame) {
      EXPECT_NEAR(std::as_const(lost).translations(frame)[0].x(), 0.02 * frame, 1e-9) << frame;
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        const Quaterniond& found = std::as_const(lost).rotations(frame)[joint];
        EXPECT_LT(found.angularDistance(clip.rotations(frame)[joint]), 0.05) << frame;
      }
    }
  }
}

TEST(LostFrames, CalibrationPosesAndFreezesAreNotLost) {
  const Clip clip = bending_chain();
  Clip calibration = clip, frozen = clip;
  lose_body(calibration, {0, 8}, true);
  lose_body(calibration, {kFrames - 6, kFrames}, true);
  Clip before = calibration;
  EXPECT_EQ(bridge_lost_frames(calibration, kWhole), 0);
  EXPECT_TRUE(same_clips(before, calibration));
  for (int frame = 21; frame < 27; ++frame) copy_frame(clip, 20, frozen, frame);
  before = frozen;
  EXPECT_EQ(bridge_lost_frames(frozen, kWhole), 0);
  EXPECT_TRUE(same_clips(before, frozen));
}

// Interpolation would invent more than a second.
TEST(LostFrames, KeepsAndNamesALongZeroPose) {
  Clip clip = bending_chain();
  lose_body(clip, {12, 47}, true);
  const Clip before = clip;
  EXPECT_EQ(bridge_lost_frames(clip, kWhole), 0);
  EXPECT_EQ(bridge_frozen_frames(clip, kWhole), 0);
  EXPECT_TRUE(same_clips(before, clip));
  EXPECT_THAT(kept_freezes(clip, kWhole, 1.0), ElementsAre(FrameRange{12, 47}));
}

// A body with fast joints that freezes twice in a row catches up to the second freeze, although it
// turns back meanwhile.
TEST(LostFrames, AFreezeAfterAFreezeIsNotLost) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    for (auto& rotation : clip.rotations(frame)) {
      rotation = exp_so3(Vector3d(1.0 + 0.6 * std::sin(0.35 * frame), 0.0, 0.0));
    }
  }
  Clip frozen = clip;
  for (int frame = 27; frame < 31; ++frame) copy_frame(clip, 26, frozen, frame);
  for (int frame = 32; frame < 36; ++frame) copy_frame(clip, 31, frozen, frame);
  EXPECT_EQ(bridge_lost_frames(frozen, kWhole), 0);
}

// A nearly straight knee gives no evidence of its own.
TEST(LostFrames, BridgesALimbThatIsLost) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    clip.rotations(frame)[2] = exp_so3(Vector3d(0.02 + 0.01 * std::sin(0.15 * frame), 0.0, 0.0));
  }
  Clip knee = clip, limb = clip;
  for (int frame = 20; frame < 25; ++frame) {
    knee.rotations(frame)[2] = limb.rotations(frame)[2] = Quaterniond::Identity();
    limb.rotations(frame)[3] = Quaterniond::Identity();
  }
  EXPECT_THAT(bridge_lost_joints(knee, kWhole), IsEmpty());
  EXPECT_THAT(bridge_lost_joints(limb, kWhole),
              ElementsAre("joint2 was lost in 5 frames", "joint3 was lost in 5 frames"));
  for (int frame = 20; frame < 25; ++frame) {
    const Quaterniond& found = std::as_const(limb).rotations(frame)[2];
    EXPECT_LT(found.angularDistance(clip.rotations(frame)[2]), 0.005) << frame;
  }
}

TEST(LostFrames, PausesAreNotFrozenFrames) {
  // The body rests for six frames and then continues the movement.
  const Clip clip = bending_chain();
  Clip resting = clip;
  for (int frame = 21; frame < 27; ++frame) copy_frame(clip, 20, resting, frame);
  for (int frame = 27; frame < kFrames; ++frame) copy_frame(clip, frame - 6, resting, frame);
  EXPECT_EQ(bridge_frozen_frames(resting, kWhole), 0);
}

TEST(LostFrames, RepeatedFramesOfASlowerClipAreNotFrozenFrames) {
  const Clip clip = bending_chain();
  Clip repeated = clip;
  for (int frame = 0; frame < kFrames; ++frame) copy_frame(clip, frame / 4 * 4, repeated, frame);
  const Clip before = repeated;
  EXPECT_EQ(bridge_frozen_frames(repeated, kWhole), 0);
  EXPECT_TRUE(same_clips(before, repeated));
}

// The source frame that each frame shows if frames of a lower rate are repeated.
int shown_frame(int frame, double share_of_rate) {
  const double captures = std::floor(frame * share_of_rate + 1e-9);
  return static_cast<int>(std::ceil(captures / share_of_rate - 1e-9));
}

TEST(HeldFrames, AreInterpolated) {
  const Clip clip = bending_chain();
  // 30 in 60 fps, 30 in 120, 24 in 60, 25 in 30.
  for (const double share : {0.5, 0.25, 0.4, 5.0 / 6.0}) {
    Clip held = clip;
    int repeated = 0, last_capture = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      const int shown = shown_frame(frame, share);
      copy_frame(clip, shown, held, frame);
      repeated += shown != frame ? 1 : 0;
      if (shown == frame) last_capture = frame;
    }
    // Nothing follows the last capture.
    const int left = kFrames - 1 - last_capture;
    EXPECT_EQ(interpolate_held_frames(held, kWhole), repeated - left) << share;
    for (int frame = 0; frame <= last_capture; ++frame) {
      EXPECT_NEAR(std::as_const(held).translations(frame)[0].x(), 0.02 * frame, 1e-9) << share;
      for (std::size_t joint = 0; joint < kJoints; ++joint) {
        const Quaterniond& found = std::as_const(held).rotations(frame)[joint];
        EXPECT_LT(found.angularDistance(clip.rotations(frame)[joint]), 0.02) << share;
      }
    }
  }
}

TEST(HeldFrames, CompleteClipsAndRestsDoNotChange) {
  const Clip clip = bending_chain();
  Clip complete = clip;
  EXPECT_EQ(interpolate_held_frames(complete, kWhole), 0);
  EXPECT_TRUE(same_clips(clip, complete));
  // Rests of six frames, after which the movement continues where it stopped.
  Clip resting = clip;
  for (int frame = 0; frame < kFrames; ++frame) {
    copy_frame(clip, frame / 12 * 6 + std::min(frame % 12, 6), resting, frame);
  }
  const Clip before = resting;
  EXPECT_EQ(interpolate_held_frames(resting, kWhole), 0);
  EXPECT_TRUE(same_clips(before, resting));
}

}  // namespace
}  // namespace retarget
