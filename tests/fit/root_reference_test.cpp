// The reference of the root's smoothness: the low-passed target of the root.

#include "solve/fit/root_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/bvh/read_bvh.h"
#include "solve/fit/fit.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

FitModel model_with_root() {
  FitModel model;
  FitTask hand, root;
  hand.link = 3;
  hand.bone = Bone::kLeftHand;
  root.link = 0;
  root.bone = Bone::kHips;
  root.horizontal_weight = root.height_weight = 29.0;
  model.tasks = {hand, root};
  return model;
}

// A clip whose second target, the root's, is `position(seconds)`.
template <typename Position>
FitClip clip_of(double fps, int frames, const Position& position) {
  FitClip clip;
  clip.frame_time = 1.0 / fps;
  clip.frame_count = frames;
  for (int t = 0; t < frames; ++t) {
    clip.targets.push_back({Vector3d::Constant(1e6 * t), Eigen::Quaterniond::Identity()});
    clip.targets.push_back({position(t / fps), Eigen::Quaterniond::Identity()});
  }
  return clip;
}

// Amplitude of the reference's position for a target that oscillates with amplitude 1 along an axis.
double gain(int axis, double hertz, double fps) {
  const int frames = static_cast<int>(6 * fps);
  const FitClip clip = clip_of(fps, frames, [&](double time) {
    return Vector3d(std::sin(2.0 * std::numbers::pi * hertz * time) * Vector3d::Unit(axis));
  });
  const RootReference reference(model_with_root(), clip.frame_time);
  double at = 0.0, low = 0.0, high = 0.0;
  for (int t = frames / 3; t < 2 * frames / 3; ++t) {
    at += reference.step(clip, t)[axis];
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return 0.5 * (high - low);
}

TEST(RootReferenceTest, ConstantVelocityPassesUnchangedUpToTheEnds) {
  const Vector3d velocity(1.0, -2.0, 0.5);
  for (const int frames : {2, 3, 5, 40}) {
    const FitClip clip =
        clip_of(30.0, frames, [&](double time) { return Vector3d(time * velocity); });
    const RootReference reference(model_with_root(), clip.frame_time);
    ASSERT_TRUE(reference.exists());
    for (int t = 0; t + 1 < frames; ++t) {
      EXPECT_LT((reference.step(clip, t) - velocity / 30.0).norm(), 1e-12) << frames << " " << t;
    }
  }
}

TEST(RootReferenceTest, KeepsBounceAndRemovesTremorAtEveryFrameRate) {
  for (const double fps : {30.0, 60.0, 120.0}) {
    SCOPED_TRACE(fps);
    EXPECT_GT(gain(2, 3.0, fps), 0.9);
    EXPECT_LT(gain(2, 11.0, fps), 0.05);
    EXPECT_GT(gain(0, 1.5, fps), 0.9);
    EXPECT_LT(gain(1, 7.0, fps), 0.05);
  }
}

TEST(RootReferenceTest, UsesTheHipsIfTheRootIsTheTorso) {
  FitModel model = model_with_root();
  model.tasks[1].link = 2;
  const Vector3d velocity(1.0, -2.0, 0.5);
  const FitClip clip = clip_of(30.0, 9, [&](double time) { return Vector3d(time * velocity); });
  const RootReference reference(model, clip.frame_time);
  ASSERT_TRUE(reference.exists());
  EXPECT_LT((reference.step(clip, 3) - velocity / 30.0).norm(), 1e-12);
}

TEST(RootReferenceTest, NeedsATargetWithAWeight) {
  FitModel model = model_with_root();
  model.tasks[1].horizontal_weight = model.tasks[1].height_weight = 0.0;
  EXPECT_FALSE(RootReference(model, 1.0 / 30.0).exists());
  model.tasks.pop_back();
  EXPECT_FALSE(RootReference(model, 1.0 / 30.0).exists());
}

// Amplitude of a track's component at this frequency.
double amplitude(const std::vector<double>& track, double hertz, double fps) {
  double sine = 0.0, cosine = 0.0;
  for (std::size_t t = 0; t < track.size(); ++t) {
    const double angle = 2.0 * std::numbers::pi * hertz * static_cast<double>(t) / fps;
    sine += track[t] * std::sin(angle);
    cosine += track[t] * std::cos(angle);
  }
  return 2.0 * std::hypot(sine, cosine) / static_cast<double>(track.size());
}

TEST(RootReferenceTest, FitKeepsTheBounceOfThePelvis) {
  // A person who stands and bounces 3 times per second. Legs bend with the hips, feet stay planted.
  const Clip deep = recorded_clip("squat");
  Clip clip = cut(deep, 0, 90);
  // Frames of the squat between standing and a slightly bent knee, back and forth.
  constexpr double kHertz = 3.0, kFps = 30.0;
  std::vector<double> human;
  for (int t = 0; t < clip.frame_count(); ++t) {
    const double phase = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * kHertz * t / kFps);
    const int from = 10 + static_cast<int>(std::lround(6.0 * phase));
    std::ranges::copy(deep.translations(from), clip.translations(t).begin());
    std::ranges::copy(deep.rotations(from), clip.rotations(t).begin());
    human.push_back(0.01 * clip.translations(t)[0].y());
  }
  const auto robot = load_g1();
  const auto limits = value_of(load_limits(*robot, "official"));
  const auto result = value_of(fit(clip, lafan1_calibration(clip.skeleton()), robot,
                                   published_config(*robot), limits, FitOptions{}));
  std::vector<double> pelvis;
  for (int t = 0; t < clip.frame_count(); ++t) pelvis.push_back(result.clip.qpos(t)[2]);
  const double source = amplitude(human, kHertz, kFps);
  ASSERT_GT(source, 0.01);
  EXPECT_GT(amplitude(pelvis, kHertz, kFps) / source, 0.6);
}

}  // namespace
}  // namespace retarget
