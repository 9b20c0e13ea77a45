#include "human/skeleton/calibrate.h"
#include "base/option_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "formats/bvh/read_bvh.h"
#include "human/hand_made_maps.h"
#include "human/limb_angles.h"
#include "human/twins.h"
#include "retarget/bvh.h"
#include "retarget/clip.h"
#include "retarget/resample.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"
#include "support/with_joints.h"

namespace retarget {
namespace {

const std::vector<std::string> kSamples = {"get_up", "squat", "turn_in_place", "walk", "wave"};

Calibration calibrated(const Clip& clip, const CalibrationOptions& options = {}) {
  return value_of(calibrate(clip, lafan1_map(clip.skeleton(), "test"), options));
}

HumanClip human_of(const Clip& clip, const CalibrationOptions& options = {}) {
  return to_human(clip, calibrated(clip, options));
}

TEST(Calibrate, KeepsLafan1BitForBit) {
  for (const std::string& name : kSamples) {
    const Clip clip = recorded_clip(name);
    const auto found = calibrate(clip, lafan1_map(clip.skeleton(), "lafan1"), {}).value();
    const HumanClip human = to_human(clip, found);
    EXPECT_EQ(found.rest_pose, "lafan1");
    EXPECT_EQ(human.height, 1.75);
    // The published formula, written out.
    Eigen::Matrix3d turn;
    turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    const Eigen::Quaterniond quarter(turn);
    std::vector<Pose> joints(clip.skeleton().joint_count());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      forward_kinematics(clip, frame, joints);
      for (const Bone bone : kMappedBones) {
        const Pose& joint = joints[clip.skeleton().find(bone_name(bone)).value()];
        const Eigen::Vector3d place = turn * joint.translation * 0.01;
        const Eigen::Quaterniond rotation = quarter * joint.rotation;
        const Pose& pose = human.frame(frame)[bone];
        ASSERT_EQ(std::memcmp(place.data(), pose.translation.data(), sizeof(double) * 3), 0);
        ASSERT_EQ(std::memcmp(rotation.coeffs().data(), pose.rotation.coeffs().data(),
                              sizeof(double) * 4),
                  0);
      }
    }
  }
}

TEST(Calibrate, Lafan1InOtherUnitsAndAxesGivesTheSameHuman) {
  const Eigen::Quaterniond z_up(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  for (const std::string& name : kSamples) {
    const Clip clip = recorded_clip(name);
    const HumanClip expected = lafan1_human(clip);
    for (const bool turned : {false, true}) {
      const Clip metres = scaled_and_turned(
          clip, 0.01, turned ? z_up : Eigen::Quaterniond(Eigen::Quaterniond::Identity()));
      const auto map = lafan1_map(metres.skeleton(), "lafan1");
      const auto found = calibrate(metres, map, {}).value();
      EXPECT_EQ(found.unit, "m");
      EXPECT_EQ(found.rest_pose, "lafan1");
      EXPECT_EQ(found.height, 1.75);
      EXPECT_EQ(to_text(found.up), turned ? "+z" : "+y") << name;
      EXPECT_LT(largest_difference(to_human(metres, found), expected), 1e-12) << name;
    }
  }
}

// A T-pose as zero pose: the general method must find LAFAN1's axes, which the copy no longer has.
TEST(Calibrate, FindsLafan1AxesWithATPoseAsZeroPose) {
  for (const std::string& name : kSamples) {
    const Clip clip = recorded_clip(name);
    HumanClip expected = lafan1_human(clip);
    const Calibration found = calibrated(with_t_pose_as_zero(clip));
    EXPECT_EQ(found.rest_pose, "zero pose");
    EXPECT_LT(found.rest_deviation, 10.0);
    expected.height = found.height;
    EXPECT_LT(largest_difference(to_human(with_t_pose_as_zero(clip), found), expected), 1e-9)
        << name;
  }
}

TEST(Calibrate, RaisesArmsOfAPosesAndIPoses) {
  const Clip clip = recorded_clip("wave");
  const HumanClip expected = human_of(with_t_pose_as_zero(clip));
  for (const double lowered : {0.6, 0.8, 1.0, M_PI / 2}) {
    const Clip twin = with_t_pose_as_zero(clip, lowered);
    const Calibration found = calibrated(twin);
    EXPECT_EQ(found.rest_pose, "zero pose");
    EXPECT_LT(largest_difference(to_human(twin, found), expected), 1e-9) << lowered;
  }
}

// A headset as the root: the trunk runs downwards, and its joints rotate other parts than their
// own.
TEST(Calibrate, RerootsTheTreeAtTheHips) {
  for (const std::string& name : kSamples) {
    const Clip clip = with_t_pose_as_zero(recorded_clip(name));
    const Clip twin = rooted_at_head(clip);
    const HumanClip expected = human_of(clip), found = human_of(twin);
    ASSERT_EQ(found.frame_count, expected.frame_count);
    double largest = 0.0;
    for (int frame = 0; frame < expected.frame_count; ++frame) {
      for (const Bone bone : kAllBones) {
        const Pose& a = expected.frame(frame)[bone];
        const Pose& b = found.frame(frame)[bone];
        largest = std::max(largest, (a.translation - b.translation).norm());
        // A headset's file does not contain the rotation of the head about the neck.
        if (bone_name(bone) == "Head") continue;
        largest = std::max(largest,
                           (a.rotation.toRotationMatrix() - b.rotation.toRotationMatrix()).norm());
      }
    }
    EXPECT_LT(largest, 1e-9) << name;
  }
}

TEST(Calibrate, UsesSkeletonFactsUnlessTheClipContradictsThem) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  BoneMap map = lafan1_map(clip.skeleton(), "test");
  // Legs of 86 units: centimetres by default, and with half an inch 1.09 m.
  map.facts.metres_per_unit = 0.0127;
  map.facts.rest = RestPose::kZero;
  auto found = calibrate(clip, map, {});
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_EQ(found->metres_per_unit, 0.0127);
  EXPECT_EQ(found->rest_pose, "zero pose");
  // Hips at 2 m are not human: the file was converted.
  map.facts.metres_per_unit = 0.0254;
  found = calibrate(clip, map, {});
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_EQ(found->unit, "cm");
  // A first frame that is not a T-pose is not used as one, for any kind of skeleton.
  map.facts.rest = RestPose::kFirst;
  found = calibrate(clip, map, {});
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_EQ(found->rest_pose, "zero pose");
  // The up axis of the kind applies unless the body clearly stands along another.
  map.facts.up = Eigen::Vector3d::UnitZ();
  found = calibrate(clip, map, {});
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_EQ(to_text(found->up), "+y");
}

TEST(Calibrate, WarnsAboutUnusualHeight) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  EXPECT_TRUE(calibrated(clip).doubts.empty());
  const Clip small = scaled_and_turned(clip, 0.6, Eigen::Quaterniond::Identity());
  const auto doubts = calibrated(small).doubts;
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_THAT(doubts[0].message, testing::HasSubstr("1.03 m is unusual"));
  EXPECT_THAT(doubts[0].message, testing::HasSubstr("not cm"));
  CalibrationOptions told;
  told.height = 1.05;
  EXPECT_TRUE(calibrated(small, told).doubts.empty());
  told = {};
  told.metres_per_unit = 0.01;
  EXPECT_TRUE(calibrated(small, told).doubts.empty());
}

std::vector<Eigen::Quaterniond> random_turns(const Clip& clip) {
  std::srand(7);
  std::vector<Eigen::Quaterniond> turns;
  for (int i = 0; i < clip.skeleton().joint_count(); ++i) {
    turns.push_back(Eigen::Quaterniond::UnitRandom());
  }
  return turns;
}

TEST(Calibrate, SameMovementInAnotherRepresentationGivesTheSameHuman) {
  const Eigen::Quaterniond z_up(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond y_up = Eigen::Quaterniond::Identity();
  for (const std::string& name : kSamples) {
    for (const bool has_rest : {false, true}) {
      const Clip clip = has_rest ? with_t_pose_as_zero(recorded_clip(name)) : recorded_clip(name);
      const HumanClip expected = human_of(clip);
      SCOPED_TRACE(name + (has_rest ? " with a T-pose" : " without a rest pose"));
      EXPECT_LT(largest_difference(human_of(scaled_and_turned(clip, 0.01, y_up)), expected), 1e-9);
      EXPECT_LT(largest_difference(human_of(scaled_and_turned(clip, 10, z_up)), expected), 1e-9);
      EXPECT_LT(largest_difference(human_of(scaled_and_turned(clip, 1 / 2.54, y_up)), expected),
                1e-9);
      EXPECT_LT(largest_difference(human_of(with_extra_joints(clip)), expected), 1e-9);
      const HumanClip half = human_of(every_nth(clip, 2));
      HumanClip picked = expected;
      picked.frame_count = half.frame_count;
      picked.world_from_bone.clear();
      for (int frame = 0; frame < half.frame_count; ++frame) {
        picked.world_from_bone.push_back(expected.frame(2 * frame));
      }
      // At 30 and 15 frames per second, every third and every other frame is sampled.
      if (has_rest) {
        EXPECT_LT(largest_difference(half, picked), 1e-9);
      }
    }
    const Clip clip = recorded_clip(name);
    EXPECT_LT(
        largest_difference(human_of(with_other_axes(clip, random_turns(clip))), human_of(clip)),
        1e-9);
  }
}

TEST(Calibrate, DoesNotDependOnTheFrameRateEvenWithoutARestPose) {
  Clip clip = recorded_clip("walk");
  const Clip fast = resample(clip, {60, 1}).value();
  const HumanClip at_60 = human_of(fast), at_30 = human_of(clip);
  for (int frame = 0; frame < at_30.frame_count; ++frame) {
    for (const Bone bone : kAllBones) {
      const Pose &a = at_30.frame(frame)[bone], &b = at_60.frame(2 * frame)[bone];
      ASSERT_LT((a.translation - b.translation).norm(), 1e-9);
      ASSERT_LT(a.rotation.angularDistance(b.rotation), 1e-6);
    }
  }
}

TEST(Calibrate, IsIndependentOfChannelOrder) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  std::vector<Joint> joints = clip.skeleton().joints();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    auto& channels = joints[i].channels;
    std::rotate(channels.end() - 3, channels.end() - 3 + static_cast<int>(i % 3), channels.end());
  }
  const auto text = value_of(format_bvh(with_joints(clip, joints)));
  EXPECT_LT(largest_difference(human_of(read_bvh(text, "twin").value().clip), human_of(clip)),
            1e-8);
}

TEST(Calibrate, LearnsAxesFromMovementCloseToTheTrueOnes) {
  // Hips, torso and legs of the synthetic person; its elbows bend exactly about -Z, unlike
  // people's, whose mean of 13 degrees is subtracted.
  const Clip clip = recorded_clip("walk");
  const Calibration found = calibrated(clip);
  EXPECT_EQ(found.rest_pose, "learned");
  const HumanClip human = to_human(clip, found), expected = lafan1_human(clip);
  for (const Bone bone : kMappedBones) {
    const double degrees =
        human.frame(0)[bone].rotation.angularDistance(expected.frame(0)[bone].rotation) * 180.0 /
        M_PI;
    EXPECT_LT(degrees, bone_name(bone).find("Arm") != std::string_view::npos ||
                               bone_name(bone).ends_with("Hand")
                           ? 14.5
                           : 6.0)
        << bone_name(bone);
  }
}

TEST(Calibrate, HandlesEveryUpAxisWithoutMirroring) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("wave"));
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool negative : {false, true}) {
      const SignedAxis up{axis, negative};
      const auto turn = Eigen::Quaterniond::FromTwoVectors(y, up.direction());
      const Clip twin = scaled_and_turned(clip, 1, turn);
      const Calibration found = calibrated(twin);
      EXPECT_EQ(found.up, up) << to_text(found.up);
      EXPECT_NEAR(found.human_from_source.determinant(), 1.0, 1e-15);
      EXPECT_TRUE(found.doubts.empty());
      const HumanClip human = to_human(twin, found);
      const auto head = human.frame(0)[Bone::kHead].translation;
      const auto hips = human.frame(0)[Bone::kHips].translation;
      EXPECT_GT(head.z() - hips.z(), 0.4);
    }
  }
}

TEST(Calibrate, FindsUpAxisOfALyingBody) {
  // The start of getting up, mostly on the floor.
  const Clip clip = with_t_pose_as_zero(cut(recorded_clip("get_up"), 0, 60));
  EXPECT_EQ(calibrated(clip).up, SignedAxis{});
  const Clip lafan1 = cut(recorded_clip("get_up"), 0, 60);
  const auto found = value_of(calibrate(lafan1, lafan1_map(lafan1.skeleton(), "lafan1"), {}));
  EXPECT_EQ(found.rest_pose, "lafan1");
}

TEST(Calibrate, LevelsTheWorldAlongAGivenVector) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  CalibrationOptions options;
  options.up = Eigen::Vector3d(0.0, 2.0, 1.0).normalized();
  const Calibration found = calibrated(clip, options);
  EXPECT_EQ(found.up, SignedAxis{});
  EXPECT_LT((found.human_from_source * *options.up - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((found.human_from_source * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitX()).norm(),
            1e-12);
  EXPECT_THAT(found.description, testing::HasSubstr("up +y levelled by 26.6 degrees"));
  options.up = Eigen::Vector3d::UnitY();
  EXPECT_EQ(calibrated(clip, options).human_from_source, calibrated(clip).human_from_source);
}

TEST(Calibrate, UsesGivenOptions) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  CalibrationOptions options;
  options.metres_per_unit = 0.02;
  options.up = Eigen::Vector3d::UnitY();
  options.height = 1.9;
  options.rest = RestPose::kFrame;
  options.rest_frame = 3;
  const Calibration found = calibrated(clip, options);
  EXPECT_EQ(found.metres_per_unit, 0.02);
  EXPECT_EQ(found.height, 1.9);
  EXPECT_EQ(found.rest_pose, "frame 3");
  options.rest_frame = 100000;
  const auto map = lafan1_map(clip.skeleton(), "test");
  EXPECT_EQ(calibrate(clip, map, options).error().kind, ErrorKind::kUsage);
}

TEST(Calibrate, UsesTheTPoseOfAnotherFile) {
  const Clip clip = recorded_clip("squat");
  // The T-pose, in the joint axes of the clip.
  Clip tpose(clip.shared_skeleton(), clip.rate(), 1);
  const Eigen::Quaterniond file_from_human(Eigen::AngleAxisd(-M_PI / 2, Eigen::Vector3d::UnitX()));
  std::vector<Eigen::Quaterniond> world;
  for (const Joint& joint : clip.skeleton().joints()) {
    const Eigen::Quaterniond axes(canonical_t_pose(bone_from_name(joint.name).value()));
    world.push_back(file_from_human * axes);
    tpose.rotations(0)[world.size() - 1] =
        joint.parent < 0 ? world.back() : world[joint.parent].inverse() * world.back();
  }
  CalibrationOptions options;
  options.tpose = tpose;
  const Calibration found = calibrated(clip, options);
  EXPECT_EQ(found.rest_pose, "T-pose file");
  HumanClip expected = lafan1_human(clip);
  expected.height = found.height;
  EXPECT_LT(largest_difference(to_human(clip, found), expected), 1e-9);
}

TEST(Calibrate, MissingBonesFollowTheirNeighbours) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  BoneMap map = lafan1_map(clip.skeleton(), "test");
  const auto drop = [&](const char* bone) { map.joint_of_bone[*bone_from_name(bone)] = -1; };
  for (const char* bone : {"LeftToe", "RightToe", "LeftHand", "RightHand", "LeftShoulder",
                           "RightShoulder", "Spine", "Spine1", "Neck"}) {
    drop(bone);
  }
  const auto found = value_of(calibrate(clip, map, {}));
  const HumanClip human = to_human(clip, found), whole = lafan1_human(recorded_clip("walk"));
  for (const Bone bone : kAllBones) EXPECT_TRUE(human.has(bone)) << bone_name(bone);
  // The wrist and the toes keep their positions, and the foot without toes keeps its rotation.
  for (const char* bone : {"LeftHand", "RightToe"}) {
    const Eigen::Vector3d apart = human.frame(5)[*bone_from_name(bone)].translation -
                                  whole.frame(5)[*bone_from_name(bone)].translation;
    EXPECT_LT(apart.norm(), 1e-9) << bone;
  }
  const Eigen::Quaterniond foot(canonical_t_pose(Bone::kLeftFoot));
  const Eigen::Quaterniond toe(canonical_t_pose(Bone::kLeftToe));
  const Eigen::Quaterniond expected =
      whole.frame(5)[Bone::kLeftFoot].rotation * foot.inverse() * toe;
  EXPECT_LT(human.frame(5)[Bone::kLeftFootMod].rotation.angularDistance(expected), 1e-6);
}

TEST(Calibrate, RejectsInvalidInput) {
  const Clip clip = recorded_clip("walk");
  BoneMap map = lafan1_map(clip.skeleton(), "test");
  const auto unit = calibrate(scaled_and_turned(clip, 30, Eigen::Quaterniond::Identity()), map, {});
  ASSERT_FALSE(unit);
  EXPECT_EQ(unit.error().kind, ErrorKind::kInput);
  EXPECT_THAT(unit.error().hint, testing::HasSubstr(OPTION("unit")));
  map.joint_of_bone[Bone::kLeftForeArm] = -1;
  const auto arm = calibrate(clip, map, {});
  ASSERT_FALSE(arm);
  EXPECT_THAT(arm.error().message, testing::HasSubstr("LeftForeArm"));
  map.partial = true;
  const auto partial = value_of(calibrate(clip, map, {}));
  EXPECT_FALSE(to_human(clip, partial).has(Bone::kLeftForeArm));
  BoneMap none;
  EXPECT_FALSE(calibrate(clip, none, {}));
}

TEST(Calibrate, WarnsAboutSwappedSides) {
  const Clip clip = recorded_clip("walk");
  BoneMap map = lafan1_map(clip.skeleton(), "test");
  for (const Bone bone : kMappedBones) {
    if (side_of(bone) != Side::kLeft) continue;
    std::swap(map.joint_of_bone[bone], map.joint_of_bone[mirrored(bone)]);
  }
  const auto found = value_of(calibrate(clip, map, {}));
  ASSERT_FALSE(found.doubts.empty());
  EXPECT_THAT(found.doubts.back().message, testing::HasSubstr("swapped"));
}

TEST(Calibrate, HandlesAClipWithoutFrames) {
  const Clip clip = with_t_pose_as_zero(recorded_clip("walk"));
  const Clip none(clip.shared_skeleton(), clip.rate(), 0);
  EXPECT_EQ(calibrated(none).rest_pose, "zero pose");
  const Clip lost(recorded_clip("walk").shared_skeleton(), {30, 1}, 0);
  EXPECT_FALSE(calibrate(lost, lafan1_map(lost.skeleton(), "test"), {}));
}

}  // namespace
}  // namespace retarget
