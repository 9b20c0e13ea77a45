#include "solve/targets/trunk_lines.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "support/angles.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// A trunk of successively rotated bones; shoulders 6 cm behind the hips in the T-pose.
HumanPose trunk(const std::array<Quaterniond, 4>& turns, const Quaterniond& clavicles) {
  HumanPose bones;
  const auto put = [&](const char* bone, const Vector3d& place, const Quaterniond& turn) {
    const Bone index = bone_from_name(bone).value();
    bones[index] = {turn * Quaterniond(canonical_t_pose(index)), place};
  };
  Quaterniond turn = turns[0];
  Vector3d at(0.4, -0.3, 1.0);
  put("Hips", at, turn);
  put("LeftUpLeg", at + turn * Vector3d(0.02, 0.1, -0.01), turn);
  put("RightUpLeg", at + turn * Vector3d(0.02, -0.1, -0.01), turn);
  const std::array<const char*, 3> spine = {"Spine", "Spine1", "Spine2"};
  for (std::size_t i = 0; i < 3; ++i) {
    at += turn * Vector3d(i == 0 ? -0.02 : 0.0, 0.0, 0.12);
    turn = turn * turns[i + 1];
    put(spine[i], at, turn);
  }
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0.0 ? "Left" : "Right";
    const Vector3d clavicle = at + turn * Vector3d(-0.02, 0.05 * side, 0.14);
    const Quaterniond raised = turn * clavicles;
    put((name + "Shoulder").c_str(), clavicle, raised);
    put((name + "Arm").c_str(), clavicle + raised * Vector3d(0.0, 0.12 * side, 0.0), raised);
  }
  return bones;
}

HumanClipInfo whole_body(int frames) {
  HumanClipInfo info;
  info.frame_count = frames;
  info.sources = BoneArray<std::string>("joint");
  return info;
}

TrunkLines standing(const HumanClipInfo& info, const HumanPose& bones) {
  return standing_trunk_lines(info,
                              [&](int, HumanPose& world_from_bone) { world_from_bone = bones; });
}

const std::array<Quaterniond, 4> kStraight = {Quaterniond::Identity(), Quaterniond::Identity(),
                                              Quaterniond::Identity(), Quaterniond::Identity()};

TEST(TrunkLines, ConnectHipsAndShoulders) {
  const TrunkLines lines = trunk_lines(trunk(kStraight, Quaterniond::Identity()));
  EXPECT_LT((lines.chord - Vector3d(-0.06, 0.0, 0.51)).norm(), 1e-12);
  EXPECT_LT((lines.across - Vector3d(0.0, 0.34, 0.0)).norm(), 1e-12);
}

TEST(TrunkLines, StandingHumanMatchesTheTPose) {
  const auto expected = trunk_lines(trunk(kStraight, Quaterniond::Identity()));
  // Bent to the side, rotated and shrugged, but not forward.
  const std::array<Quaterniond, 4> posed = {exp_so3({0.3, 0.2, 1.9}), exp_so3({0.2, 0.0, 0.3}),
                                            exp_so3({-0.1, 0.0, 0.2}), exp_so3({0.1, 0.0, -0.4})};
  const TrunkLines lines = standing(whole_body(7), trunk(posed, exp_so3({0.3, 0.0, 0.0})));
  EXPECT_LT((lines.chord - expected.chord).norm(), 1e-12);
  EXPECT_LT((lines.across - expected.across).norm(), 1e-12);
}

TEST(TrunkLines, NaturallyBentSpineIsUpright) {
  const auto bent = [](double degrees) {
    const Quaterniond part = exp_so3({0.0, degrees * kDegree / 3.0, 0.0});
    return trunk({Quaterniond::Identity(), part, part, part}, Quaterniond::Identity());
  };
  const double back = std::atan2(0.06, 0.51);
  const auto lean = [&](double degrees) {
    const Vector3d chord = standing(whole_body(3), bent(degrees)).chord;
    EXPECT_NEAR(chord.norm(), std::hypot(0.06, 0.51), 1e-12);
    return -std::atan2(chord.x(), chord.z());
  };
  EXPECT_NEAR(lean(0.0), back, 1e-12);
  EXPECT_NEAR(lean(3.0), back, 1e-9);
  EXPECT_NEAR(lean(6.5), 0.5 * back, 1e-9);
  EXPECT_NEAR(lean(10.0), 0.0, 1e-9);
  EXPECT_NEAR(lean(60.0), 0.0, 1e-9);
  EXPECT_NEAR(lean(-20.0), back, 1e-12);
}

TEST(TrunkLines, AreLearnedFromStandingFrames) {
  // The body bends over in three frames of four: the bend of the spine then has no information.
  const Quaterniond part = exp_so3({0.0, 20 * kDegree, 0.0});
  const auto bent = trunk({exp_so3({0.0, 1.0, 0.0}), part, part, part}, Quaterniond::Identity());
  const auto upright = trunk(kStraight, Quaterniond::Identity());
  const TrunkLines lines =
      standing_trunk_lines(whole_body(40), [&](int frame, HumanPose& world_from_bone) {
        world_from_bone = frame % 4 == 0 ? upright : bent;
      });
  EXPECT_LT((lines.chord - trunk_lines(upright).chord).norm(), 1e-12);
}

// The body is upright in three frames, or for a second. One more frame must not change the lines.
TEST(TrunkLines, DoNotJumpWithTheLengthOfTheClip) {
  const Quaterniond part = exp_so3({0.0, 20 * kDegree, 0.0});
  const auto bent = trunk({exp_so3({0.0, 1.0, 0.0}), part, part, part}, Quaterniond::Identity());
  const auto upright = trunk(kStraight, Quaterniond::Identity());
  const auto lean = [&](int frames, int begin, int end) {
    const Vector3d chord =
        standing_trunk_lines(whole_body(frames), [&](int frame, HumanPose& world_from_bone) {
          world_from_bone = frame >= begin && frame < end ? upright : bent;
        }).chord;
    return std::atan2(chord.x(), chord.z());
  };
  for (int begin = 240; begin < 250; ++begin) {
    EXPECT_NEAR(lean(400, begin, begin + 3), lean(401, begin, begin + 3), 0.1 * kDegree) << begin;
  }
  EXPECT_NEAR(lean(401, 240, 270), -std::atan2(0.06, 0.51), 1e-9);
}

TEST(TrunkLines, UseTheBendOfTheWholeClip) {
  HumanClipInfo part = whole_body(5);
  part.standing_bend = 20.0 * kDegree;
  EXPECT_NEAR(standing(part, trunk(kStraight, Quaterniond::Identity())).chord.x(), 0.0, 1e-9);
}

TEST(TrunkLines, DoNotNeedClaviclesAndSpine) {
  HumanClipInfo info = whole_body(2);
  for (const char* bone : {"LeftShoulder", "RightShoulder", "Spine", "Spine1", "Spine2"}) {
    info.sources[bone_from_name(bone).value()].clear();
  }
  const auto expected = trunk_lines(trunk(kStraight, Quaterniond::Identity()));
  const Quaterniond turn = exp_so3({0.4, 0.8, -2.0});
  const auto bones = trunk({turn, kStraight[1], kStraight[2], kStraight[3]}, kStraight[0]);
  EXPECT_LT((standing(info, bones).chord - expected.chord).norm(), 1e-12);
}

TEST(TrunkFrame, IsARotationUnlessLinesAreParallel) {
  const auto frame = trunk_frame({{0.1, 0.0, 0.5}, {0.05, 0.3, 0.1}}).value();
  EXPECT_LT((frame * frame.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(frame.determinant(), 1.0, 1e-12);
  EXPECT_LT((frame.col(2) - Vector3d(0.1, 0.0, 0.5).normalized()).norm(), 1e-12);
  EXPECT_GT(frame.col(1).y(), 0.9);
  EXPECT_FALSE(trunk_frame({}));
  EXPECT_FALSE(trunk_frame({{0.0, 0.0, 0.5}, {0.0, 0.0, 0.3}}));
}

}  // namespace
}  // namespace retarget
