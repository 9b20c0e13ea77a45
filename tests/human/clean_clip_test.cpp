#include "human/gait/clean_clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "human/skeleton/human_clip.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

CleanReport clean(Clip& clip) {
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  return clean_clip(clip, {0, clip.frame_count()}, calibration);
}

// centimetres
double farthest_root(const Clip& a, const Clip& b) {
  double far = 0.0;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    far = std::max(far, (a.translations(frame)[0] - b.translations(frame)[0]).norm());
  }
  return far;
}

double mean_angle(const Clip& a, const Clip& b) {
  double sum = 0.0;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    for (std::size_t joint = 0; joint < a.rotations(frame).size(); ++joint) {
      sum += log_so3(a.rotations(frame)[joint].conjugate() * b.rotations(frame)[joint]).norm();
    }
  }
  return sum / a.frame_count() / a.skeleton().joint_count();
}

// Sums of uniform numbers, which are equal in every standard library.
class Noise {
 public:
  double next() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random_()) / 4294967296.0;
    return sum;
  }

 private:
  std::mt19937 random_{11};
};

TEST(CleanClip, DoesNotChangeSamples) {
  for (const char* name : {"walk", "turn_in_place", "squat", "wave", "get_up"}) {
    const Clip clip = recorded_clip(name);
    Clip cleaned = clip;
    EXPECT_THAT(clean(cleaned).notes, IsEmpty()) << name;
    EXPECT_EQ(farthest_root(clip, cleaned), 0.0) << name;
    EXPECT_EQ(mean_angle(clip, cleaned), 0.0) << name;
  }
}

TEST(CleanClip, RemovesSwayFromTheRoot) {
  const Clip clip = recorded_clip("squat");
  Clip noisy = clip;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    noisy.translations(frame)[0].x() += 20.0 * std::sin(2.0 * std::numbers::pi * frame / 120.0);
  }
  const Clip swaying = noisy;
  const CleanReport report = clean(noisy);
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("the root moved by up to")));
  EXPECT_EQ(report.foot_speed, 0.0);
  EXPECT_GT(farthest_root(clip, swaying), 19.0);
  // The position of the body as a whole is unknown.
  EXPECT_LT(farthest_root(clip, noisy), 4.0);
  EXPECT_EQ(mean_angle(clip, noisy), 0.0);
}

TEST(CleanClip, SmoothsJointJitter) {
  const Clip clip = recorded_clip("wave");
  Clip noisy = clip;
  Noise noise;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (auto& rotation : noisy.rotations(frame)) {
      rotation = rotation * exp_so3(0.03 * Vector3d(noise.next(), noise.next(), noise.next()));
    }
  }
  const Clip jittery = noisy;
  const CleanReport report = clean(noisy);
  ASSERT_FALSE(report.notes.empty());
  EXPECT_THAT(report.notes.front(), HasSubstr("jitter of"));
  EXPECT_GT(report.foot_speed, 0.1);
  EXPECT_LT(mean_angle(clip, noisy), 0.6 * mean_angle(clip, jittery));
}

// Noise with a correlation time of 0.3 s and this RMS angle about each axis, degrees.
void add_slow_noise(Clip& clip, double degrees) {
  Noise noise;
  const double keep = std::exp(-clip.rate().frame_time() / 0.3);
  const double sigma = degrees * std::numbers::pi / 180.0;
  std::vector<Vector3d> errors(static_cast<std::size_t>(clip.skeleton().joint_count()),
                               Vector3d::Zero());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t joint = 0; joint < errors.size(); ++joint) {
      const Vector3d fresh(noise.next(), noise.next(), noise.next());
      errors[joint] = keep * errors[joint] + std::sqrt(1.0 - keep * keep) * sigma * fresh;
      Eigen::Quaterniond& rotation = clip.rotations(frame)[joint];
      rotation = rotation * exp_so3(errors[joint]);
    }
  }
}

SourceFeet feet_of_clip(const Clip& clip) {
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  const HumanClip human = to_human(clip, calibration);
  return {human, human.frame_count};
}

// Over frames in which the foot ends of the clean clip are in contact.
double contact_speed(const Clip& clean_clip, const Clip& other, double percent) {
  const ContactPlan contacts = find_contacts(feet_of_clip(clean_clip));
  const SourceFeet feet = feet_of_clip(other);
  std::vector<double> speeds;
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    for (int foot = 0; foot < 2; ++foot) {
      for (const int end : {kHeelEnd, kToeEnd}) {
        if (contacts.in_contact(foot, end, frame)) speeds.push_back(feet.speed(frame, foot, end));
      }
    }
  }
  return percentile(speeds, percent);
}

TEST(CleanClip, HoldsFeetInTheirStances) {
  for (const char* name : {"walk", "squat"}) {
    const Clip clip = recorded_clip(name);
    Clip noisy = clip;
    add_slow_noise(noisy, 3.0 / std::sqrt(3.0));
    const Clip before = noisy;
    const CleanReport report = clean(noisy);
    ASSERT_FALSE(report.notes.empty()) << name;
    EXPECT_THAT(report.notes.back(), HasSubstr("of feet held")) << name;
    EXPECT_GT(contact_speed(clip, before, 50.0), 0.2) << name;
    EXPECT_LT(contact_speed(clip, noisy, 50.0), 0.005) << name;
  }
}

TEST(CleanClip, DoesNotChangeFramesOutsideThePart) {
  Clip noisy = recorded_clip("squat");
  for (int frame = 0; frame < noisy.frame_count(); ++frame) {
    noisy.translations(frame)[0].x() += 20.0 * std::sin(2.0 * std::numbers::pi * frame / 120.0);
  }
  Clip cleaned = noisy;
  const Calibration calibration = lafan1_calibration(noisy.skeleton());
  EXPECT_TRUE(clean_clip(cleaned, {30, 150}, calibration).acted());
  EXPECT_EQ(cleaned.translations(29)[0], noisy.translations(29)[0]);
  EXPECT_NE(cleaned.translations(31)[0], noisy.translations(31)[0]);
}

TEST(CleanClip, DoesNotChangeShortClips) {
  const Clip clip = recorded_clip("squat");
  for (const int frames : {0, 1, 2, 3, 5}) {
    Clip part = cut(clip, 0, frames);
    EXPECT_FALSE(clean(part).acted()) << frames;
  }
}

TEST(CleanPositions, DoesNotChangeClipsWithRotations) {
  Clip clip = recorded_clip("wave");
  Noise noise;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0].x() += noise.next();
  }
  EXPECT_EQ(clean_positions(clip), "");
}

}  // namespace
}  // namespace retarget
