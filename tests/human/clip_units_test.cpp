// Clips made from the samples whose angles or root translations have other units than the rest of
// the file.

#include "human/skeleton/units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "formats/bvh/euler_angles.h"
#include "formats/bvh/read_bvh.h"
#include "human/hand_made_maps.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/recognise.h"
#include "human/tiny_skeleton.h"
#include "human/twins.h"
#include "retarget/so3.h"
#include "support/recorded_clip.h"
#include "support/shared_data.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::vector<std::string> kSamplesInUnits = {"walk", "squat", "turn_in_place", "wave",
                                                  "get_up"};

// A sample with LAFAN1's axes, whose zero pose is impossible for a body, or with a T-pose as zero
// pose.
Clip sample_of(const std::string& name, bool with_t_pose) {
  const Clip clip = recorded_clip(name);
  return with_t_pose ? with_t_pose_as_zero(clip) : clip;
}

std::vector<std::string> repair(Clip& clip) {
  const BoneMap map = lafan1_map(clip.skeleton(), "test");
  std::vector<std::string> messages;
  for (const Warning& warning : repair_clip_units(clip, map)) messages.push_back(warning.message);
  if (const auto missing = find_missing_root(clip, map, Eigen::Vector3d::UnitY())) {
    messages.push_back(missing->message);
  }
  return messages;
}

// The clip of a reader that mistakes radians for degrees.
Clip with_radians_read_as_degrees(Clip clip) {
  constexpr std::array<int, 3> kAxes = {2, 1, 0};
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (Eigen::Quaterniond& rotation : clip.rotations(frame)) {
      std::array<double, 3> none{}, angles{};
      euler_angles(rotation, kAxes, none, angles);
      rotation = Eigen::Quaterniond::Identity();
      for (std::size_t i = 0; i < 3; ++i) {
        rotate_about(rotation, kAxes[i], angles[i] * M_PI / 180.0);
      }
    }
  }
  return clip;
}

Clip with_root(Clip clip, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& change) {
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0] = change(clip.translations(frame)[0]);
  }
  return clip;
}

void expect_same(const Clip& found, const Clip& wanted) {
  for (int frame = 0; frame < wanted.frame_count(); ++frame) {
    for (int joint = 0; joint < wanted.skeleton().joint_count(); ++joint) {
      ASSERT_LT(found.rotations(frame)[joint].angularDistance(wanted.rotations(frame)[joint]), 1e-6)
          << frame << " " << joint;
    }
    ASSERT_LT((found.translations(frame)[0] - wanted.translations(frame)[0]).norm(), 1e-6) << frame;
  }
}

TEST(ClipUnits, DoesNotChangeCleanClips) {
  for (const std::string& name : kSamplesInUnits) {
    for (const bool t_pose : {false, true}) {
      const Clip clip = sample_of(name, t_pose);
      Clip repaired = clip;
      EXPECT_THAT(repair(repaired), IsEmpty()) << name;
      for (int frame = 0; frame < clip.frame_count(); ++frame) {
        ASSERT_EQ(repaired.translations(frame)[0], clip.translations(frame)[0]);
        ASSERT_EQ(repaired.rotations(frame)[5].coeffs(), clip.rotations(frame)[5].coeffs());
      }
    }
  }
}

TEST(ClipUnits, ConvertsRadians) {
  for (const std::string& name : kSamplesInUnits) {
    const Clip clip = sample_of(name, false);
    Clip repaired = with_radians_read_as_degrees(clip);
    EXPECT_THAT(repair(repaired), ElementsAre(HasSubstr("in radians"))) << name;
    expect_same(repaired, clip);
  }
  // If the zero pose is one of a body, only the feet give evidence.
  for (const std::string name : {"walk", "squat", "get_up"}) {
    const Clip clip = sample_of(name, true);
    Clip repaired = with_radians_read_as_degrees(clip);
    EXPECT_THAT(repair(repaired), ElementsAre(HasSubstr("in radians"))) << name;
    expect_same(repaired, clip);
  }
}

TEST(ClipUnits, ConvertsRootTranslations) {
  for (const std::string name : {"walk", "squat", "get_up"}) {
    for (const double factor : {0.001, 0.01, 0.1, 1.0 / 2.54, 2.54, 10.0, 100.0}) {
      const Clip clip = sample_of(name, true);
      Clip repaired = with_root(clip, [&](const Eigen::Vector3d& at) { return at * factor; });
      EXPECT_THAT(repair(repaired), ElementsAre(HasSubstr("unit of the root translation differs")))
          << name << factor;
      expect_same(repaired, clip);
    }
  }
}

TEST(ClipUnits, PositionsHaveOneUnit) {
  for (const double factor : {0.01, 2.54}) {
    Clip clip =
        with_root(sample_of("walk", true), [&](const Eigen::Vector3d& at) { return at * factor; });
    ClipOrigin origin = clip.origin();
    origin.unknown_rotations = {"Hips"};
    clip.set_origin(origin);
    const Clip positions = clip;
    EXPECT_THAT(repair(clip), Not(Contains(HasSubstr("multiplied by")))) << factor;
    expect_same(clip, positions);
  }
}

TEST(ClipUnits, WarnsAboutARatioThatMatchesNoUnits) {
  const Clip clip = sample_of("walk", true);
  for (const double factor : {0.2, 5.0}) {
    const Clip changed = with_root(clip, [&](const Eigen::Vector3d& at) { return at * factor; });
    Clip repaired = changed;
    EXPECT_THAT(repair(repaired), ElementsAre(HasSubstr("multiplied by"))) << factor;
    expect_same(repaired, changed);
  }
}

TEST(ClipUnits, WarnsAboutMovingFeetUnderAStaticRoot) {
  const Clip walk = sample_of("walk", true);
  const Eigen::Vector3d first = walk.translations(0)[0];
  const std::vector<std::function<Eigen::Vector3d(const Eigen::Vector3d&)>> changes = {
      [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0, 0); },
      [&](const Eigen::Vector3d&) { return first; },
      [](const Eigen::Vector3d& at) { return Eigen::Vector3d(0, at.y(), 0); }};
  for (const auto& change : changes) {
    const Clip centred = with_root(walk, change);
    Clip repaired = centred;
    EXPECT_THAT(repair(repaired),
                ElementsAre(HasSubstr("the planted feet move and the root does not")));
    expect_same(repaired, centred);
  }
  // A standing body needs no movement of the root.
  const Clip wave = sample_of("wave", true);
  Clip still = with_root(wave, changes[1]);
  EXPECT_THAT(repair(still), IsEmpty());
}

std::vector<std::string> doubts_of_path(const Clip& clip) {
  const BoneMap map = lafan1_map(clip.skeleton(), "test");
  const auto doubt = doubt_root_path(clip, map, Eigen::Vector3d::UnitY());
  return doubt ? std::vector<std::string>{doubt->message} : std::vector<std::string>();
}

TEST(ClipUnits, WarnsAboutAWrongPath) {
  const Clip walk = sample_of("walk", true);
  using Vector = Eigen::Vector3d;
  for (const double factor : {0.5, 0.7, 1.5, 2.0}) {
    const Clip scaled = with_root(
        walk, [&](const Vector& at) { return Vector(factor * at.x(), at.y(), factor * at.z()); });
    EXPECT_THAT(doubts_of_path(scaled),
                ElementsAre(HasSubstr("horizontal path of the root is multiplied by")))
        << factor;
  }
  const std::vector<std::function<Vector(const Vector&)>> wrong = {
      [](const Vector& at) { return Vector(-at.x(), at.y(), -at.z()); },
      [](const Vector& at) { return Vector(at.z(), at.y(), at.x()); }};
  for (const auto& change : wrong) {
    EXPECT_THAT(doubts_of_path(with_root(walk, change)),
                ElementsAre(HasSubstr("mirrored or turned")));
  }
}

TEST(ClipUnits, DoesNotDoubtRightPaths) {
  for (const std::string& name : kSamplesInUnits) {
    EXPECT_THAT(doubts_of_path(sample_of(name, true)), IsEmpty()) << name;
  }
  // Skaters and carried bodies.
  const Clip glide = with_root(sample_of("wave", true), [frame = 0](const auto& at) mutable {
    return Eigen::Vector3d(at.x() + 6.0 * ++frame, at.y(), at.z());
  });
  EXPECT_THAT(doubts_of_path(glide), IsEmpty());
}

// A person in a headstand sways: the feet move, the hips hardly do.
TEST(ClipUnits, IgnoresFeetThatDoNotCarryTheBody) {
  const Clip wave = sample_of("wave", true);
  const BoneMap map = lafan1_map(wave.skeleton(), "test");
  const Eigen::Vector3d head = frame_pose(wave, 0)[map.joint(Bone::kHead)].translation;
  Clip clip = wave;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double sway = 0.15 * std::sin(0.8 * M_PI * clip.rate().frame_time() * frame);
    const Eigen::Quaterniond turn = exp_so3({0.0, 0.0, sway}) * exp_so3({M_PI, 0.0, 0.0});
    copy_frame(wave, 0, clip, frame);
    clip.rotations(frame)[0] = turn * clip.rotations(frame)[0];
    clip.translations(frame)[0] = turn * (clip.translations(frame)[0] - head);
  }
  EXPECT_THAT(repair(clip), IsEmpty());
  // The feet of an upright body that moves like this do not stand.
  EXPECT_TRUE(find_missing_root(clip, map, -Eigen::Vector3d::UnitY()));
}

// Noise in all joints with a correlation time of 0 or 0.2 s, and a frame in which the tracking was
// lost.
TEST(ClipUnits, IgnoresNoiseOfStandingFeet) {
  for (const char* name : {"wave", "turn_in_place"}) {
    for (const double kept : {0.0, 0.85}) {
      Clip noisy = sample_of(name, true);
      std::mt19937 random(3);
      std::normal_distribution<double> noise(0.0,
                                             5.0 * M_PI / 180.0 * std::sqrt(1.0 - kept * kept));
      std::vector<Eigen::Vector3d> errors(noisy.rotations(0).size(), Eigen::Vector3d::Zero());
      for (int frame = 0; frame < noisy.frame_count(); ++frame) {
        for (std::size_t joint = 0; joint < errors.size(); ++joint) {
          errors[joint] *= kept;
          errors[joint] += Eigen::Vector3d(noise(random), noise(random), noise(random));
          noisy.rotations(frame)[joint] = noisy.rotations(frame)[joint] * exp_so3(errors[joint]);
        }
      }
      for (Eigen::Quaterniond& rotation : noisy.rotations(noisy.frame_count() / 2)) {
        rotation = Eigen::Quaterniond::Identity();
      }
      EXPECT_THAT(repair(noisy), IsEmpty()) << name << kept;
    }
  }
}

// As in a run on the spot.
TEST(ClipUnits, FindsAMissingPathUnderABouncingRoot) {
  const Clip walk = sample_of("walk", true);
  Clip centred = walk;
  for (int frame = 0; frame < walk.frame_count(); ++frame) {
    const double bounce = 0.04 * std::sin(2.0 * M_PI * 3.0 * frame * walk.rate().frame_time());
    const double height = walk.translations(frame)[0].y();
    centred.translations(frame)[0] = {0.0, height * (1.0 + bounce), 0.0};
  }
  EXPECT_THAT(repair(centred), ElementsAre(HasSubstr("the root does not")));
}

// A body that is carried, skates or sits in a vehicle moves without planted feet.
TEST(ClipUnits, DoesNotChangeCarriedBodies) {
  Clip clip = sample_of("wave", true);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0] += Eigen::Vector3d(6.0 * frame, 0.0, 0.0);
  }
  const Clip before = clip;
  EXPECT_THAT(repair(clip), IsEmpty());
  expect_same(clip, before);
}

TEST(ClipUnits, DoesNotChangeRecordings) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  for (const char* name :
       {"lafan1_cuts/run2_subject4_run.bvh", "lafan1_cuts/jumps1_subject5_big.bvh",
        "dialects/cmu_motionbuilder_12_01_walk.bvh", "dialects/xsens_boxing_120fps.bvh"}) {
    Clip clip = load_bvh((*shared_folder() / "data" / name).string()).value().clip;
    const BoneMap map = recognise_skeleton(clip, shipped_profiles()).value();
    EXPECT_THAT(repair_clip_units(clip, map), IsEmpty()) << name;
    const Eigen::Vector3d up =
        calibrate(clip, map, {}).value().human_from_source.row(2).transpose();
    EXPECT_FALSE(find_missing_root(clip, map, up)) << name;
    EXPECT_FALSE(doubt_root_path(clip, map, up)) << name;
  }
}

}  // namespace
}  // namespace retarget
