#include "human/gait/clean_clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "formats/smpl/joint_motion.h"
#include "human/gait/contact_plan.h"
#include "human/gait/joint_jitter.h"
#include "human/gait/source_feet.h"
#include "human/gait/track_faults.h"
#include "human/gait/track_noise.h"
#include "human/skeleton/joint_clip.h"
#include "retarget/human.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"
#include "support/lafan1_map.h"
#include "support/normal_numbers.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

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
  EXPECT_EQ(report.foot_noise.speed, 0.0);
  EXPECT_GT(farthest_root(clip, swaying), 19.0);
  // The position of the body as a whole is unknown.
  EXPECT_LT(farthest_root(clip, noisy), 4.0);
  EXPECT_EQ(mean_angle(clip, noisy), 0.0);
  // Feet may sway with the body that carries them.
  Clip carried = swaying;
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  EXPECT_FALSE(
      clean_clip(carried, {0, clip.frame_count()}, calibration, {}, RootRule::kKept).acted());
  EXPECT_EQ(farthest_root(swaying, carried), 0.0);
}

// Joints of LAFAN1's skeleton whose names begin so keep their first rotation.
void freeze(Clip& clip, const std::vector<std::string>& beginnings) {
  for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
    const std::string& name = clip.skeleton().joint(joint).name;
    const bool frozen = std::ranges::any_of(
        beginnings, [&](const std::string& beginning) { return name.starts_with(beginning); });
    for (int frame = 1; frozen && frame < clip.frame_count(); ++frame) {
      clip.rotations(frame)[static_cast<std::size_t>(joint)] =
          std::as_const(clip).rotations(0)[static_cast<std::size_t>(joint)];
    }
  }
}

StillLimbs still_limbs(const Clip& clip) {
  return find_still_limbs(clip, lafan1_calibration(clip.skeleton()));
}

TEST(CleanClip, ALegThatIsNotTrackedDoesNotMoveTheRoot) {
  Clip clip = recorded_clip("walk");
  freeze(clip, {"LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe"});
  EXPECT_THAT(still_limbs(clip).names, ElementsAre("left leg"));
  EXPECT_TRUE(still_limbs(clip).leg);
  Clip cleaned = clip;
  EXPECT_THAT(clean(cleaned).notes, IsEmpty());
  EXPECT_EQ(farthest_root(clip, cleaned), 0.0);
}

TEST(CleanClip, FindsAnArmThatIsNotTracked) {
  Clip clip = recorded_clip("walk");
  freeze(clip, {"RightShoulder", "RightArm", "RightForeArm", "RightHand"});
  EXPECT_THAT(still_limbs(clip).names, ElementsAre("right arm"));
  EXPECT_FALSE(still_limbs(clip).leg);
}

TEST(CleanClip, LimbsMayRest) {
  for (const char* name : {"walk", "turn_in_place", "squat", "wave", "get_up"}) {
    EXPECT_THAT(still_limbs(recorded_clip(name)).names, IsEmpty()) << name;
  }
  // A leg that stands, and both arms that carry something.
  Clip standing = recorded_clip("wave");
  freeze(standing, {"Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe"});
  Clip carrying = recorded_clip("walk");
  freeze(carrying, {"LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "RightShoulder",
                    "RightArm", "RightForeArm", "RightHand"});
  for (const Clip& clip : {standing, carrying}) {
    EXPECT_THAT(still_limbs(clip).names, IsEmpty());
  }
}

// Independent errors of this RMS angle about each axis, degrees.
Clip with_white_noise(const Clip& clip, double degrees) {
  Clip noisy = clip;
  NormalNumbers noise(11);
  const double sigma = degrees * std::numbers::pi / 180.0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (auto& rotation : noisy.rotations(frame)) {
      rotation = rotation * exp_so3(sigma * noise.next_vector());
    }
  }
  return noisy;
}

// Speed of feet, m/s, that the best smoothing leaves of independent errors of this RMS angle about
// each axis, degrees: of the noisier foot, at the end of a leg of 0.85 m. Two axes of the hips and
// of the hip joint move it, and half of those of the knee.
double foot_speed_of_white_noise(const Clip& noisy, double degrees) {
  const double sigma = degrees * std::numbers::pi / 180.0, time = noisy.rate().frame_time();
  const NoisePower power{3.0 * sigma * sigma, 0.0};
  const auto square_of = [&](const std::string& name) {
    const auto track =
        rotation_track(noisy, {0, noisy.frame_count()}, noisy.skeleton().find(name).value());
    const auto cutoff = best_cutoff(track, power, time, 1.5);
    const double speed =
        rest_of(power, cutoff ? smoothing_strength(*cutoff, time) : 0.0, time).speed;
    return 2.0 / 3.0 * speed * speed;
  };
  double most = 0.0;
  for (const std::string side : {"Left", "Right"}) {
    most = std::max(most,
                    square_of("Hips") + square_of(side + "UpLeg") + 0.25 * square_of(side + "Leg"));
  }
  return 0.85 * std::sqrt(most);
}

TEST(CleanClip, SmoothsJointJitter) {
  const Clip clip = recorded_clip("wave");
  const Clip jittery = with_white_noise(clip, 1.7);
  Clip noisy = jittery;
  const CleanReport report = clean(noisy);
  ASSERT_FALSE(report.notes.empty());
  EXPECT_THAT(report.notes.front(), HasSubstr("jitter of"));
  const double speed = foot_speed_of_white_noise(jittery, 1.7);
  EXPECT_GT(report.foot_noise.speed, speed / 1.3);
  EXPECT_LT(report.foot_noise.speed, 1.3 * speed);
  EXPECT_LT(mean_angle(clip, noisy), 0.6 * mean_angle(clip, jittery));
}

// Independent errors are small after smoothing: neither the root nor the stances need to move, and
// what remains of them is no speed of feet.
TEST(CleanClip, OnlySmoothsWhiteNoise) {
  for (const char* name : {"walk", "turn_in_place", "squat"}) {
    const Clip clip = recorded_clip(name);
    for (const double degrees : {0.2, 0.5, 1.0, 2.0, 4.0}) {
      const Clip jittery = with_white_noise(clip, degrees);
      Clip noisy = jittery;
      const CleanReport report = clean(noisy);
      EXPECT_THAT(report.notes, ElementsAre(HasSubstr("jitter of"))) << name << degrees;
      EXPECT_LT(mean_angle(clip, noisy), 0.9 * mean_angle(clip, jittery)) << name << degrees;
      // m/s, without smoothing: two axes of the hips, the hip joint and half of the knee move the
      // foot at the end of a leg of 0.85 m; over 1/15 s.
      const double unsmoothed =
          0.85 * std::sqrt(2.0 * 2.25) * std::sqrt(2.0) * 15.0 * degrees * std::numbers::pi / 180.0;
      EXPECT_LT(report.foot_noise.speed, 0.8 * unsmoothed) << name << degrees;
      const double smoothed = foot_speed_of_white_noise(jittery, degrees);
      EXPECT_GT(report.foot_noise.speed, smoothed / 1.5) << name << degrees;
      EXPECT_LT(report.foot_noise.speed, 1.5 * smoothed) << name << degrees;
    }
  }
}

// RMS distance of the roots, centimetres.
double root_error(const Clip& a, const Clip& b) {
  double sum = 0.0;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    sum += (a.translations(frame)[0] - b.translations(frame)[0]).squaredNorm();
  }
  return std::sqrt(sum / a.frame_count());
}

// Independent errors of the root shake both feet, so that stances cannot be found to correct it.
TEST(CleanClip, SmoothsIndependentErrorsOfTheRoot) {
  for (const char* name : {"walk", "turn_in_place", "squat", "get_up"}) {
    const Clip clip = recorded_clip(name);
    for (const double degrees : {0.3, 1.0}) {
      for (const double error : {0.5, 1.0}) {
        Clip noisy = with_white_noise(clip, degrees);
        NormalNumbers noise(7);
        for (int frame = 0; frame < clip.frame_count(); ++frame) {
          noisy.translations(frame)[0] += error * noise.next_vector();
        }
        const Clip jittery = noisy;
        const CleanReport report = clean(noisy);
        EXPECT_THAT(report.notes, Contains(HasSubstr("jitter of the root")))
            << name << degrees << ' ' << error;
        EXPECT_LT(root_error(clip, noisy), 0.65 * root_error(clip, jittery))
            << name << degrees << ' ' << error;
      }
    }
  }
}

// Every second frame is in the middle of its neighbours.
TEST(CleanClip, InterpolatedFramesAreNoJitter) {
  for (const char* name : {"walk", "squat"}) {
    Clip clip = recorded_clip(name);
    for (int frame = 1; frame + 1 < clip.frame_count(); frame += 2) {
      for (std::size_t joint = 0; joint < clip.rotations(frame).size(); ++joint) {
        clip.rotations(frame)[joint] = std::as_const(clip).rotations(frame - 1)[joint].slerp(
            0.5, std::as_const(clip).rotations(frame + 1)[joint]);
      }
    }
    EXPECT_THAT(clean(clip).notes, IsEmpty()) << name;
  }
}

// Noise with a correlation time of 0.3 s and this RMS angle about each axis, degrees.
// @param names  of the noisy joints; empty: all
void add_slow_noise(Clip& clip, double degrees, const std::set<std::string>& names = {}) {
  NormalNumbers noise(11);
  const double keep = std::exp(-clip.rate().frame_time() / 0.3);
  const double sigma = degrees * std::numbers::pi / 180.0;
  std::vector<Vector3d> errors(static_cast<std::size_t>(clip.skeleton().joint_count()),
                               Vector3d::Zero());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t joint = 0; joint < errors.size(); ++joint) {
      const Vector3d fresh(noise.next(), noise.next(), noise.next());
      errors[joint] = keep * errors[joint] + std::sqrt(1.0 - keep * keep) * sigma * fresh;
      const std::string& name = clip.skeleton().joint(static_cast<int>(joint)).name;
      if (!names.empty() && !names.contains(name)) continue;
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

TEST(CleanClip, SmoothsOneNoisyLeg) {
  const Clip clip = recorded_clip("walk");
  Clip noisy = clip;
  add_slow_noise(noisy, 4.0, {"LeftUpLeg", "LeftLeg", "LeftFoot"});
  const Clip before = noisy;
  const CleanReport report = clean(noisy);
  ASSERT_FALSE(report.notes.empty());
  EXPECT_THAT(report.notes.front(), HasSubstr("median of 3 joints of the left leg) smoothed"));
  EXPECT_GT(report.foot_noise.speed, 0.0);
  EXPECT_GT(contact_speed(clip, before, 75.0), 0.2);
  EXPECT_LT(contact_speed(clip, noisy, 75.0), 0.6 * contact_speed(clip, before, 75.0));
  // The other limbs do not change.
  for (const char* name : {"RightUpLeg", "RightLeg", "LeftArm", "Spine1"}) {
    const auto joint = static_cast<std::size_t>(*clip.skeleton().find(name));
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      EXPECT_EQ(noisy.rotations(frame)[joint].coeffs(), clip.rotations(frame)[joint].coeffs());
    }
  }
}

// Independent errors of the hands and the head do not determine those of a leg.
TEST(CleanClip, OtherJointsDoNotDecideTheKindOfNoiseOfALimb) {
  const Clip clip = recorded_clip("walk");
  const Clip white = with_white_noise(clip, 2.0);
  Clip noisy = clip;
  add_slow_noise(noisy, 4.0, {"LeftUpLeg", "LeftLeg", "LeftFoot"});
  for (const char* name : {"RightHand", "LeftHand", "Head"}) {
    const auto joint = static_cast<std::size_t>(clip.skeleton().find(name).value());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      noisy.rotations(frame)[joint] = white.rotations(frame)[joint];
    }
  }
  const CleanReport report = clean(noisy);
  ASSERT_FALSE(report.notes.empty());
  EXPECT_THAT(report.notes.front(), HasSubstr("median of 3 joints of the left leg) smoothed"));
  EXPECT_GT(report.foot_noise.wander, 0.0);
}

// At double speed, the legs of the walk look noisy, but the feet stand between the steps.
TEST(CleanClip, TellsAFastLegFromANoisyOne) {
  const Clip walk = recorded_clip("walk");
  Clip clip(walk.shared_skeleton(), walk.rate(), walk.frame_count() / 2);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    std::ranges::copy(walk.rotations(2 * frame), clip.rotations(frame).begin());
    std::ranges::copy(walk.translations(2 * frame), clip.translations(frame).begin());
  }
  Clip calm = clip;
  EXPECT_THAT(clean(calm).notes, Not(Contains(HasSubstr("jitter"))));
  add_slow_noise(clip, 4.0, {"LeftUpLeg", "LeftLeg", "LeftFoot"});
  EXPECT_THAT(clean(clip).notes, Contains(HasSubstr("of the left leg) smoothed")));
}

TEST(CleanClip, SmoothsNoisyHips) {
  Clip noisy = recorded_clip("walk");
  add_slow_noise(noisy, 2.0, {"Hips"});
  const CleanReport report = clean(noisy);
  ASSERT_FALSE(report.notes.empty());
  EXPECT_THAT(report.notes.front(), HasSubstr("median of 1 joint of the hips) smoothed"));
}

TEST(CleanClip, NoisyArmsDoNotMoveFeet) {
  const Clip clip = recorded_clip("wave");
  Clip noisy = clip;
  add_slow_noise(noisy, 4.0, {"RightArm", "RightForeArm"});
  const Clip before = noisy;
  const CleanReport report = clean(noisy);
  EXPECT_THAT(report.notes, ElementsAre(HasSubstr("2 joints of the right arm) smoothed")));
  EXPECT_EQ(report.foot_noise.speed, 0.0);
  EXPECT_EQ(farthest_root(clip, noisy), 0.0);
  EXPECT_LT(mean_angle(clip, noisy), mean_angle(clip, before));
}

// Single noisy joints are usual in good recordings, and a degree of noise in a leg is small.
TEST(CleanClip, DoesNotSmoothSingleJointsAndSmallNoiseOfALimb) {
  const Clip clip = recorded_clip("walk");
  for (const char* name : {"LeftFoot", "RightToe", "LeftHand", "Neck", "Head"}) {
    Clip noisy = clip;
    add_slow_noise(noisy, 2.0, {name});
    EXPECT_THAT(clean(noisy).notes, Not(Contains(HasSubstr("jitter")))) << name;
  }
  Clip noisy = clip;
  add_slow_noise(noisy, 0.3, {"LeftUpLeg", "LeftLeg", "LeftFoot"});
  EXPECT_THAT(clean(noisy).notes, Not(Contains(HasSubstr("jitter"))));
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
  NormalNumbers noise(11);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.translations(frame)[0].x() += noise.next();
  }
  EXPECT_EQ(clean_positions(clip).note, "");
}

// The clip as a file of joint positions.
Clip positions_of(const Clip& clip, const std::vector<int>& raised) {
  const int count = clip.skeleton().joint_count();
  JointMotion motion;
  motion.frame_count = clip.frame_count();
  motion.joint_count = count;
  motion.names = clip.skeleton().names();
  motion.rate = clip.rate();
  std::vector<Pose> world(static_cast<std::size_t>(count));
  const int foot = clip.skeleton().find("LeftFoot").value();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    for (const Pose& pose : world) motion.positions.push_back(pose.translation);
    if (std::ranges::find(raised, frame) == raised.end()) continue;
    motion.positions[motion.index(frame, foot)] += Vector3d(20.0, 0.0, 40.0);
  }
  return clip_of_joints(motion, "walk.npy").value();
}

TEST(PositionSpikes, AreBridgedBeforeRotationsAreComputed) {
  const Clip clip = recorded_clip("walk");
  Clip clean = positions_of(clip, {}), spiky = positions_of(clip, {100, 101, 102});
  const Clip before = spiky;
  EXPECT_THAT(bridge_position_spikes(clean), IsEmpty());
  EXPECT_THAT(bridge_position_spikes(spiky), ElementsAre("LeftFoot jumped away in 3 frames"));
  EXPECT_EQ(spiky.skeleton().names(), clean.skeleton().names());
  EXPECT_FALSE(spiky.origin().unknown_rotations.empty());
  EXPECT_LT(mean_angle(clean, spiky), 0.2 * mean_angle(clean, before));
  Clip rotations = clip;
  rotations.translations(100)[0].x() += 100.0;
  EXPECT_THAT(bridge_position_spikes(rotations), IsEmpty());
}

// Such feet hardly slide.
TEST(CleanClip, NamesTheEvidenceForADrift) {
  Clip sinking = recorded_clip("squat");
  for (int frame = 0; frame < sinking.frame_count(); ++frame) {
    sinking.translations(frame)[0].y() -= 15.0 * frame / sinking.frame_count();
  }
  const CleanReport report = clean(sinking);
  ASSERT_EQ(report.notes.size(), 1U);
  EXPECT_THAT(report.notes[0], HasSubstr("standing feet sank by 0.1"));
  EXPECT_THAT(report.notes[0], Not(HasSubstr("slid")));
}

TEST(CleanClip, FindsAClipOfOnePose) {
  Clip clip = recorded_clip("walk");
  EXPECT_FALSE(still_limbs(clip).all);
  freeze(clip, {"Left", "Right", "Spine"});
  EXPECT_TRUE(still_limbs(clip).all);
  EXPECT_THAT(still_limbs(clip).names, IsEmpty());
}

}  // namespace
}  // namespace retarget
