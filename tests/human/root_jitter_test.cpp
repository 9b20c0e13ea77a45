#include "human/gait/root_jitter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "human/gait/body_joint.h"
#include "retarget/human_skeleton.h"
#include "retarget/resample.h"
#include "support/lafan1_map.h"
#include "support/normal_numbers.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

std::optional<RootJitter> smooth_root_of(Clip& clip, bool white = false) {
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  return smooth_root_jitter(clip, {0, clip.frame_count()}, calibration, white);
}

Clip at_rate(const char* name, int fps) {
  return resample(recorded_clip(name), frame_rate_from_fps(fps)).value();
}

// Independent errors of this RMS length along each axis, centimetres.
Clip with_root_noise(Clip clip, double length, int slot = 0) {
  NormalNumbers noise(7);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[static_cast<std::size_t>(slot)] += length * noise.next_vector();
  }
  return clip;
}

// The same motion below a joint that rests at the origin and has position channels.
Clip below_resting_joint(const Clip& clip) {
  const Channel all[] = {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition,
                         Channel::kZRotation, Channel::kYRotation, Channel::kXRotation};
  std::vector<Joint> joints = clip.skeleton().joints();
  for (Joint& joint : joints) ++joint.parent;
  Joint reference;
  reference.name = "Reference";
  reference.channels.assign(std::begin(all), std::end(all));
  joints.insert(joints.begin(), reference);
  Clip moved(std::make_shared<const Skeleton>(joints), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    std::ranges::copy(clip.rotations(frame), moved.rotations(frame).begin() + 1);
    std::ranges::copy(clip.translations(frame), moved.translations(frame).begin() + 1);
  }
  return moved;
}

Vector3d hips_of(const Clip& clip, int frame) {
  std::vector<Pose> world(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, frame, world);
  return world[static_cast<std::size_t>(clip.skeleton().find("Hips").value())].translation;
}

// RMS distance of the hips, centimetres.
double hips_error(const Clip& a, const Clip& b) {
  double sum = 0.0;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    sum += (hips_of(a, frame) - hips_of(b, frame)).squaredNorm();
  }
  return std::sqrt(sum / a.frame_count());
}

TEST(RootJitter, OfTheJointThatMovesIsSmoothed) {
  const Clip clip = below_resting_joint(recorded_clip("walk"));
  for (const int noisy_joint : {0, 1}) {
    const Clip jittery = with_root_noise(clip, 1.0, noisy_joint);
    Clip smoothed = jittery;
    ASSERT_TRUE(smooth_root_of(smoothed)) << noisy_joint;
    EXPECT_LT(hips_error(clip, smoothed), 0.65 * hips_error(clip, jittery)) << noisy_joint;
  }
}

// A root that was computed from the hips, whose translation compensates its errors.
TEST(RootJitter, OfTwoJointsMayCancel) {
  Clip clip = with_root_noise(below_resting_joint(recorded_clip("walk")), 1.0);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[1] -= clip.translations(frame)[0];
  }
  EXPECT_FALSE(smooth_root_of(clip));
}

// A root at 30 frames per second in a file with 60 has no errors, and smoothing flattens its path.
TEST(RootJitter, HeldValuesAreNone) {
  for (const char* name : {"walk", "squat", "turn_in_place", "get_up"}) {
    Clip clip = at_rate(name, 60);
    for (int frame = 1; frame < clip.frame_count(); frame += 2) {
      clip.translations(frame)[0] = std::as_const(clip).translations(frame - 1)[0];
    }
    for (const bool white : {false, true}) {
      EXPECT_FALSE(smooth_root_of(clip, white)) << name << white;
    }
  }
}

TEST(RootJitter, VibrationIsNone) {
  Clip clip = at_rate("walk", 60);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0].y() += std::sin(2.0 * std::numbers::pi * 25.0 * frame / 60.0);
  }
  EXPECT_FALSE(smooth_root_of(clip));
}

// Smoothing must not spread a jump over its neighbours, because no warning would name it.
TEST(RootJitter, IsSmoothedBesideJumps) {
  Clip clip = recorded_clip("walk");
  const int middle = clip.frame_count() / 2;
  for (int frame = middle; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0].x() += 40.0;
  }
  const Clip jittery = with_root_noise(clip, 1.0);
  Clip smoothed = jittery;
  ASSERT_TRUE(smooth_root_of(smoothed));
  EXPECT_LT(hips_error(clip, smoothed), 0.65 * hips_error(clip, jittery));
  EXPECT_GT((hips_of(smoothed, middle) - hips_of(smoothed, middle - 1)).norm(), 35.0);
}

// Its steps are faster than bodies.
TEST(RootJitter, IsSmoothedAtHighRates) {
  const Clip clip = at_rate("walk", 120);
  const Clip jittery = with_root_noise(clip, 2.0);
  Clip smoothed = jittery;
  ASSERT_TRUE(smooth_root_of(smoothed));
  EXPECT_LT(hips_error(clip, smoothed), 0.5 * hips_error(clip, jittery));
}

}  // namespace
}  // namespace retarget
