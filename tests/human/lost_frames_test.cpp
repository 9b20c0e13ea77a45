#include "human/gait/repeated_frames.h"
#include "human/gait/track_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "human/gait/track_spikes.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kJoints = 4, kFrames = 60;

// A chain that swings, never near its zero pose, on a root that moves along x.
Clip bending_chain() {
  std::vector<Joint> joints(kJoints);
  for (int i = 0; i < kJoints; ++i) {
    joints[static_cast<std::size_t>(i)] = {
        "joint" + std::to_string(i), i - 1, Vector3d::UnitY(), {}, {}};
  }
  joints[0].channels = {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition};
  Clip clip(std::make_shared<const Skeleton>(joints), FrameRate{30, 1}, kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    clip.translations(frame)[0] = Vector3d(0.02 * frame, 1.0, 0.0);
    for (int joint = 0; joint < kJoints; ++joint) {
      const double angle = 1.0 + 0.3 * std::sin(0.15 * frame + joint);
      clip.rotations(frame)[static_cast<std::size_t>(joint)] = exp_so3(Vector3d(angle, 0.0, 0.0));
    }
  }
  return clip;
}

bool same_clips(const Clip& a, const Clip& b) {
  for (int frame = 0; frame < kFrames; ++frame) {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      if (a.rotations(frame)[joint].coeffs() != b.rotations(frame)[joint].coeffs()) return false;
    }
    if (a.translations(frame)[0] != b.translations(frame)[0]) return false;
  }
  return true;
}

constexpr FrameRange kWhole{0, kFrames};

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

TEST(Spikes, AreInterpolated) {
  const Clip clip = bending_chain();
  Clip spiky = clip;
  spiky.rotations(20)[1] = clip.rotations(20)[1] * exp_so3(Vector3d(0.0, 2.0, 0.0));
  for (const int frame : {40, 41}) spiky.translations(frame)[0].z() += 0.5;
  EXPECT_THAT(bridge_spikes(spiky, kWhole, 1.0),
              ElementsAre("joint0 jumped away in 2 frames", "joint1 jumped away in 1 frame"));
  for (int frame = 0; frame < kFrames; ++frame) {
    const Quaterniond& found = std::as_const(spiky).rotations(frame)[1];
    EXPECT_LT(found.angularDistance(clip.rotations(frame)[1]), 0.01) << frame;
    EXPECT_LT((std::as_const(spiky).translations(frame)[0] - clip.translations(frame)[0]).norm(),
              1e-9);
  }
}

// The joint turns by 12 degrees per frame, more than 0.35 of a jump by 0.55 rad.
TEST(Spikes, OfMovingJointsAreInterpolated) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    clip.rotations(frame)[1] = exp_so3(Vector3d(0.2 * frame, 0.0, 0.0));
  }
  for (const double jump : {0.55, -0.55, 1.0, -1.0}) {
    for (const int frames : {1, 2, 3}) {
      Clip spiky = clip;
      for (int frame = 20; frame < 20 + frames; ++frame) {
        spiky.rotations(frame)[1] = clip.rotations(frame)[1] * exp_so3(Vector3d(jump, 0.0, 0.0));
      }
      EXPECT_THAT(bridge_spikes(spiky, kWhole, 1.0), SizeIs(1)) << jump << ' ' << frames;
      for (int frame = 18; frame < 25; ++frame) {
        EXPECT_LT(std::as_const(spiky).rotations(frame)[1].angularDistance(
                      std::as_const(clip).rotations(frame)[1]),
                  1e-6);
      }
    }
  }
}

// The joint turns by more than 30 degrees per frame, so it hardly turns into the gap.
TEST(Spikes, AgainstFastMovementsAreInterpolated) {
  Clip clip = bending_chain();
  for (int frame = 0; frame < kFrames; ++frame) {
    clip.rotations(frame)[1] = exp_so3(Vector3d(0.6 * frame, 0.0, 0.0));
  }
  for (const int begin : {1, 2, 20}) {
    Clip spiky = clip;
    spiky.rotations(begin)[1] = clip.rotations(begin - 1)[1] * exp_so3(Vector3d(-0.05, 0.0, 0.0));
    EXPECT_THAT(bridge_spikes(spiky, kWhole, 1.0), ElementsAre("joint1 jumped away in 1 frame"));
    EXPECT_LT(std::as_const(spiky).rotations(begin)[1].angularDistance(
                  std::as_const(clip).rotations(begin)[1]),
              1e-6)
        << begin;
  }
}

TEST(Spikes, FastMovementsAndCutsAreNone) {
  const Clip clip = bending_chain();
  Clip fast = clip;
  // A shake with 3.75 Hz and up to 36 degrees per frame.
  for (int frame = 0; frame < kFrames; ++frame) {
    fast.rotations(frame)[1] = exp_so3(Vector3d(0.8 * std::sin(0.785 * frame), 0.0, 0.0));
  }
  Clip before = fast;
  EXPECT_THAT(bridge_spikes(fast, kWhole, 1.0), IsEmpty());
  EXPECT_TRUE(same_clips(before, fast));
  // The body jumps to another place in frame 30.
  Clip cut = clip;
  for (int frame = 30; frame < kFrames; ++frame) cut.translations(frame)[0].z() += 0.5;
  before = cut;
  EXPECT_THAT(bridge_spikes(cut, kWhole, 1.0), IsEmpty());
  EXPECT_TRUE(same_clips(before, cut));
  // In centimetres, the same number is below the smallest jump.
  Clip small = clip;
  small.translations(40)[0].z() += 0.5;
  EXPECT_THAT(bridge_spikes(small, kWhole, 0.01), IsEmpty());
}

// Positions of a root that moves along x and of two legs that swing past each other.
std::vector<std::vector<Vector3d>> striding_points() {
  std::vector<std::vector<Vector3d>> tracks(5);
  for (int frame = 0; frame < kFrames; ++frame) {
    const Vector3d root(0.05 * frame, 1.0, 0.0);
    const double swing = 0.3 * std::sin(0.2 * frame);
    tracks[0].push_back(root);
    tracks[1].push_back(root + Vector3d(0.5 * swing, -0.4, 0.1));
    tracks[2].push_back(root + Vector3d(swing, -0.8, 0.1));
    tracks[3].push_back(root + Vector3d(-0.5 * swing, -0.4, -0.1));
    tracks[4].push_back(root + Vector3d(-swing, -0.8, -0.1));
  }
  return tracks;
}

std::vector<std::string> bridge_points(std::vector<std::vector<Vector3d>>& tracks) {
  return bridge_spikes(tracks, {"hips", "left_knee", "left_ankle", "right_knee", "right_ankle"},
                       FrameRate{30, 1}, 0.1);
}

double farthest_point(const std::vector<std::vector<Vector3d>>& a,
                      const std::vector<std::vector<Vector3d>>& b) {
  double far = 0.0;
  for (std::size_t joint = 0; joint < a.size(); ++joint) {
    for (std::size_t i = 0; i < a[joint].size(); ++i) {
      far = std::max(far, (a[joint][i] - b[joint][i]).norm());
    }
  }
  return far;
}

TEST(Spikes, OfPositionsAreInterpolated) {
  const auto points = striding_points();
  auto ankle = points, body = points, hips = points;
  for (const std::size_t i : {30, 31, 32}) ankle[2][i] += Vector3d(0.0, 0.4, 0.2);
  EXPECT_THAT(bridge_points(ankle), ElementsAre("left_ankle jumped away in 3 frames"));
  EXPECT_LT(farthest_point(points, ankle), 0.03);
  for (auto& track : body) track[20] += Vector3d(1.0, 0.0, 1.0);
  EXPECT_THAT(bridge_points(body), ElementsAre("the body jumped away in 1 frame"));
  EXPECT_LT(farthest_point(points, body), 1e-9);
  hips[0][20] += Vector3d(0.0, 0.3, 0.0);
  EXPECT_THAT(bridge_points(hips), ElementsAre("hips jumped away in 1 frame"));
  EXPECT_LT(farthest_point(points, hips), 1e-9);
}

TEST(Spikes, ExchangedLegsAreInterpolated) {
  const auto points = striding_points();
  for (const std::size_t at : {16, 20, 25, 30, 40}) {
    auto swapped = points;
    std::swap(swapped[1][at], swapped[3][at]);
    std::swap(swapped[2][at], swapped[4][at]);
    EXPECT_THAT(
        bridge_points(swapped),
        ElementsAre("left_knee, left_ankle, right_knee, right_ankle jumped away in 1 frame"))
        << at;
    EXPECT_LT(farthest_point(points, swapped), 0.01) << at;
  }
}

TEST(Spikes, FastPointsAndCutsAreNone) {
  const auto points = striding_points();
  auto clean = points, kicking = points, cut = points;
  EXPECT_THAT(bridge_points(clean), IsEmpty());
  // A foot at up to 9 m/s.
  for (std::size_t i = 0; i < kFrames; ++i) {
    const double far = 0.5 * std::sin(0.6 * static_cast<double>(i));
    kicking[2][i] += Vector3d(far * std::abs(far) / 0.5, std::abs(far), 0.0);
    if (i >= 30) {
      for (auto& track : cut) track[i].z() += 0.5;
    }
  }
  EXPECT_THAT(bridge_points(kicking), IsEmpty());
  EXPECT_THAT(bridge_points(cut), IsEmpty());
}

}  // namespace
}  // namespace retarget
