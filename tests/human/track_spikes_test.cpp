#include "human/gait/track_spikes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "human/bending_chain.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

using namespace track_test;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

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
