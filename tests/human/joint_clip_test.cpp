// Joint positions become a clip: rotations from directions, orders without names, synthetic ground
// truth.

#include "human/skeleton/joint_clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "formats/smpl/joint_motion.h"
#include "human/skeleton/joint_tree.h"
#include "retarget/clip.h"
#include "support/angles.h"
#include "support/value_of.h"
#include "support/world_poses.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;

// A body with z up and x ahead, posed by its joint angles.
struct Figure {
  double left_knee = 0.3, right_knee = 0.2;    // Bend, rad.
  double left_elbow = 0.4, right_elbow = 0.5;  // Bend, rad.
  double arm_turn = 0.0;  // Rotation of both elbow hinges about their upper arms, rad.
  double lean = 0.0;      // Forward lean of the trunk, rad.
  double heading = 0.0;   // Rotation of the whole body about the vertical, rad.
  Vector3d root = {0.1, 0.2, 0.95};
};

Quaterniond about(const Vector3d& axis, double angle) {
  return Quaterniond(Eigen::AngleAxisd(angle, axis));
}

// Positions with SMPL's first 22 names.
std::vector<Vector3d> places_of(const Figure& figure) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  std::vector<Vector3d> at(22, Vector3d::Zero());
  const Quaterniond trunk = about(y, figure.lean);
  const auto leg = [&](int hip, int knee, int ankle, int foot, double side, double bend) {
    at[hip] = side * 0.09 * y - 0.06 * z;
    at[knee] = at[hip] + about(y, -0.5 * bend) * (-0.4 * z);
    at[ankle] = at[knee] + about(y, 0.5 * bend) * (-0.42 * z);
    at[foot] = at[ankle] + 0.13 * x - 0.06 * z;
  };
  leg(1, 4, 7, 10, 1.0, figure.left_knee);
  leg(2, 5, 8, 11, -1.0, figure.right_knee);
  at[3] = trunk * (0.1 * z);
  at[6] = trunk * (0.24 * z);
  at[9] = trunk * (0.3 * z);
  at[12] = trunk * (0.5 * z);
  at[15] = trunk * (0.6 * z);
  const auto arm = [&](int collar, int shoulder, int elbow, int wrist, double side, double bend) {
    at[collar] = trunk * Vector3d(0, side * 0.06, 0.42);
    at[shoulder] = trunk * Vector3d(0, side * 0.18, 0.44);
    // Arms in a T-pose; the forearm moves ahead, rotated about the upper arm.
    const Vector3d out = trunk * (side * y);
    const Quaterniond turn = about(out, figure.arm_turn);
    const Vector3d hinge = turn * (trunk * (-side * z));
    at[elbow] = at[shoulder] + 0.28 * out;
    at[wrist] = at[elbow] + 0.26 * (about(hinge, bend) * out);
  };
  arm(13, 16, 18, 20, 1.0, figure.left_elbow);
  arm(14, 17, 19, 21, -1.0, figure.right_elbow);
  const Quaterniond heading = about(z, figure.heading);
  for (Vector3d& place : at) place = figure.root + heading * place;
  return at;
}

JointMotion motion_of(const std::vector<Figure>& figures, bool named = true) {
  JointMotion motion;
  motion.frame_count = static_cast<int>(figures.size());
  motion.joint_count = 22;
  for (const Figure& figure : figures) {
    const auto places = places_of(figure);
    motion.positions.insert(motion.positions.end(), places.begin(), places.end());
  }
  if (named) motion.names = joint_orders().front().names();
  return motion;
}

// A body that walks about and bends all joints.
std::vector<Figure> moving(int frames = 60) {
  std::vector<Figure> figures;
  for (int i = 0; i < frames; ++i) {
    const double t = 0.1 * i;
    Figure figure;
    figure.left_knee = 0.6 + 0.5 * std::sin(t);
    figure.right_knee = 0.6 - 0.5 * std::sin(t);
    figure.left_elbow = 0.9 + 0.5 * std::sin(2 * t);
    figure.right_elbow = 0.9 + 0.5 * std::cos(2 * t);
    figure.arm_turn = 0.3 * std::sin(t);
    figure.lean = 0.1 * std::sin(t);
    figure.heading = 0.05 * i;
    figure.root = {0.02 * i, 0.1 * std::sin(t), 0.95};
    figures.push_back(figure);
  }
  return figures;
}

Clip clip_of(const JointMotion& motion) {
  return value_of(clip_of_joints(motion, "walk.npy"));
}

int joint_of(const Clip& clip, const std::string& name) {
  return clip.skeleton().find(name).value();
}

std::string warnings_of(const Clip& clip) {
  std::string text;
  for (const Warning& warning : clip.origin().warnings) text += warning.message + "\n";
  return text;
}

TEST(JointClipTest, KeepsJointPositions) {
  const JointMotion motion = motion_of(moving());
  const Clip clip = clip_of(motion);
  ASSERT_EQ(clip.skeleton().joint_count(), 22);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto world = world_poses(clip, frame);
    for (int joint = 0; joint < 22; ++joint) {
      const Vector3d& place = world[joint_of(clip, motion.names[joint])].translation;
      EXPECT_LT((place - motion.position(frame, joint)).norm(), 1e-9) << motion.names[joint];
    }
  }
}

TEST(JointClipTest, LimbsOfFixedLengthHaveFixedOffsets) {
  const Clip clip = clip_of(motion_of(moving()));
  for (const char* name : {"left_knee", "right_ankle", "left_elbow", "right_wrist", "left_foot"}) {
    const int joint = joint_of(clip, name);
    EXPECT_LT(clip.skeleton().translation_slot(joint), 0) << name;
  }
  EXPECT_NEAR(clip.skeleton().joint(joint_of(clip, "left_knee")).offset.norm(), 0.4, 1e-9);
}

TEST(JointClipTest, TheZeroPoseIsATPose) {
  const Clip clip = clip_of(motion_of(moving()));
  Clip zero = clip.empty_like(clip.rate(), 1);
  const auto world = world_poses(zero, 0);
  const auto way = [&](const char* from, const char* to) {
    return Vector3d(
        (world[joint_of(clip, to)].translation - world[joint_of(clip, from)].translation)
            .normalized());
  };
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  EXPECT_GT(way("left_shoulder", "left_wrist").dot(y), 0.999);
  EXPECT_GT(way("right_shoulder", "right_wrist").dot(-y), 0.999);
  EXPECT_GT(way("left_hip", "left_ankle").dot(-z), 0.999);
  EXPECT_GT(way("right_hip", "right_ankle").dot(-z), 0.999);
  EXPECT_GT(way("pelvis", "head").dot(z), 0.99);
  EXPECT_GT(way("left_ankle", "left_foot").dot(x), 0.8);
}

// Rotation of a joint between two frames.
double turn_between(const Clip& clip, const std::string& name, int a, int b) {
  const int joint = joint_of(clip, name);
  return world_poses(clip, a)[joint].rotation.angularDistance(world_poses(clip, b)[joint].rotation);
}

TEST(JointClipTest, PlaneOfTheBendDeterminesTheRoll) {
  // Elbows stay bent while the upper arm rotates about itself.
  std::vector<Figure> figures(2);
  for (Figure& figure : figures) figure.left_elbow = figure.right_elbow = 0.8;
  figures[1].arm_turn = 0.5;
  const Clip clip = clip_of(motion_of(figures));
  // The plane of the previous frame has a weight of one fiftieth.
  EXPECT_NEAR(turn_between(clip, "left_shoulder", 0, 1), 0.5, 0.02);
  EXPECT_NEAR(turn_between(clip, "right_shoulder", 0, 1), 0.5, 0.02);
  EXPECT_NEAR(turn_between(clip, "left_hip", 0, 1), 0.0, 1e-9);
}

TEST(JointClipTest, StraightLimbsDoNotTwist) {
  // The elbow straightens, stays straight with a minimal bend the wrong way, and bends again.
  std::vector<Figure> figures;
  for (int i = 0; i <= 60; ++i) {
    Figure figure;
    figure.left_elbow = 1.2 * std::abs(i - 30) / 30.0;
    if (i >= 28 && i <= 32) figure.left_elbow = -0.02;
    figure.left_knee = 1e-7 * i;
    figure.heading = 0.02 * i;
    figures.push_back(figure);
  }
  const Clip clip = clip_of(motion_of(figures));
  for (int i = 0; i < 60; ++i) {
    // Only the heading changes.
    EXPECT_NEAR(turn_between(clip, "left_shoulder", i, i + 1), 0.02, 1e-6) << i;
    EXPECT_NEAR(turn_between(clip, "left_hip", i, i + 1), 0.02, 1e-6) << i;
  }
}

TEST(JointClipTest, LimbsThatNeverBendTurnWithTheBody) {
  std::vector<Figure> figures(20);
  for (int i = 0; i < 20; ++i) {
    figures[i].left_knee = figures[i].right_knee = 0.0;
    figures[i].left_elbow = figures[i].right_elbow = 0.0;
    figures[i].heading = 0.1 * i;
  }
  const Clip clip = clip_of(motion_of(figures));
  for (const char* name : {"left_hip", "left_knee", "left_shoulder", "right_elbow", "pelvis"}) {
    EXPECT_NEAR(turn_between(clip, name, 0, 19), 1.9, 1e-6) << name;
  }
}

TEST(JointClipTest, WarnsAboutUnknownRotations) {
  const Clip clip = clip_of(motion_of(moving()));
  EXPECT_THAT(clip.origin().unknown_rotations,
              testing::UnorderedElementsAre("left_wrist", "right_wrist", "head"));
  EXPECT_THAT(warnings_of(clip), HasSubstr("left_wrist"));
  EXPECT_THAT(warnings_of(clip), HasSubstr("is unknown and follows neighbouring joints"));
  EXPECT_THAT(warnings_of(clip), Not(HasSubstr("limb lengths vary")));
}

TEST(JointClipTest, WarnsAboutVaryingLimbLengths) {
  JointMotion motion = motion_of(moving());
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    motion.positions[motion.index(frame, 20)] *= frame % 2 == 0 ? 1.06 : 0.94;
  }
  const Clip clip = clip_of(motion);
  EXPECT_THAT(warnings_of(clip), HasSubstr("limb lengths vary by"));
  const auto world = world_poses(clip, 7);
  EXPECT_LT((world[joint_of(clip, "left_wrist")].translation - motion.position(7, 20)).norm(),
            1e-9);
}

// The same positions in another order.
JointMotion in_order(const JointMotion& motion, const JointOrder& order,
                     const std::vector<std::string>& own_names) {
  JointMotion made;
  made.frame_count = motion.frame_count;
  const std::vector<std::string> names = order.names();
  made.joint_count = static_cast<int>(names.size());
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    for (const std::string& name : own_names) {
      const auto found = std::find(motion.names.begin(), motion.names.end(), name);
      made.positions.push_back(
          motion.position(frame, static_cast<int>(found - motion.names.begin())));
    }
  }
  return made;
}

TEST(JointClipTest, FindsTheJointOrderFromPositions) {
  const JointMotion motion = motion_of(moving());
  const Clip smpl = clip_of(motion_of(moving(), false));
  EXPECT_THAT(warnings_of(smpl), HasSubstr("the joint order of SMPL"));
  // The same positions in LAFAN1's order, left or right first.
  const std::vector<std::string> left = {"left_hip", "left_knee", "left_ankle", "left_foot"};
  const std::vector<std::string> right = {"right_hip", "right_knee", "right_ankle", "right_foot"};
  const std::vector<std::string> trunk = {"spine1", "spine2", "spine3", "neck", "head"};
  const std::vector<std::string> left_arm = {"left_collar", "left_shoulder", "left_elbow",
                                             "left_wrist"};
  const std::vector<std::string> right_arm = {"right_collar", "right_shoulder", "right_elbow",
                                              "right_wrist"};
  for (const bool right_first : {false, true}) {
    std::vector<std::string> names = {"pelvis"};
    for (const auto* part :
         {right_first ? &right : &left, right_first ? &left : &right, &trunk,
          right_first ? &right_arm : &left_arm, right_first ? &left_arm : &right_arm}) {
      names.insert(names.end(), part->begin(), part->end());
    }
    const JointOrder& order = joint_orders()[right_first ? 2 : 1];
    const Clip clip = clip_of(in_order(motion, order, names));
    EXPECT_THAT(warnings_of(clip), HasSubstr("the joint order of " + std::string(order.name)));
    EXPECT_LT(
        (world_poses(clip, 9)[joint_of(clip, "LeftForeArm")].translation - motion.position(9, 18))
            .norm(),
        1e-9);
  }
}

std::string error_of(const JointMotion& motion) {
  const Result<Clip> clip = clip_of_joints(motion, "walk.npy");
  if (clip) return "no error";
  EXPECT_EQ(clip.error().location.file, "walk.npy");
  return describe(clip.error(), option_as_flag);
}

TEST(JointClipTest, RejectsUnknownBodies) {
  JointMotion motion = motion_of(moving(), false);
  std::reverse(motion.positions.begin(), motion.positions.end());
  EXPECT_THAT(error_of(motion),
              HasSubstr("the positions of the 22 joints do not form a human in the"));
  EXPECT_THAT(error_of(motion), HasSubstr("--joint-names"));
  motion.joint_count = 11;
  motion.frame_count *= 2;
  EXPECT_THAT(error_of(motion), HasSubstr("no known joint order has 11 joints"));
  motion = motion_of(moving());
  motion.names[3] = "pelvis";
  EXPECT_THAT(error_of(motion), HasSubstr("two joints are called \"pelvis\""));
  for (std::size_t i = 0; i < motion.names.size(); ++i) motion.names[i] = "m" + std::to_string(i);
  EXPECT_THAT(error_of(motion), HasSubstr("no human found in the joints m0, m1"));
  // All joints at one position.
  motion = motion_of(moving(), false);
  for (Vector3d& place : motion.positions) place.setZero();
  EXPECT_THAT(error_of(motion), HasSubstr("do not form a human"));
}

TEST(JointClipTest, AddsATrunkToKeypoints) {
  // COCO: a face and limbs without hips, spine and toes.
  const JointMotion body = motion_of(moving());
  JointMotion motion;
  motion.frame_count = body.frame_count;
  motion.joint_count = 17;
  for (int frame = 0; frame < body.frame_count; ++frame) {
    const Vector3d head = body.position(frame, 15);
    for (const Vector3d& off :
         {Vector3d(0.1, 0, 0), Vector3d(0.08, 0.03, 0.03), Vector3d(0.08, -0.03, 0.03),
          Vector3d(0, 0.07, 0), Vector3d(0, -0.07, 0)}) {
      motion.positions.push_back(head + off);
    }
    for (const int joint : {16, 17, 18, 19, 20, 21, 1, 2, 4, 5, 7, 8}) {
      motion.positions.push_back(body.position(frame, joint));
    }
  }
  const Clip clip = clip_of(motion);
  EXPECT_THAT(warnings_of(clip), HasSubstr("the joint order of COCO"));
  EXPECT_THAT(warnings_of(clip), HasSubstr("no joints for pelvis, chest, head"));
  EXPECT_THAT(clip.origin().unknown_rotations, testing::Contains("left_ankle"));
  EXPECT_TRUE(clip.skeleton().find("chest").has_value());
}

// A foot that stands would otherwise tilt with its shin, and its toes would be below the floor.
TEST(JointClipTest, FeetWithoutToesAreLevelUnlessTheBodyKneels) {
  std::vector<Figure> figures = moving();
  for (int i = 0; i < 60; ++i) {
    figures[i].left_knee = 0.1 + 0.045 * i;
    figures[i].heading = 0.0;
    figures[i].root = {0.0, 0.0, 0.95};
  }
  const JointMotion body = motion_of(figures);
  JointMotion motion;
  motion.frame_count = body.frame_count;
  motion.joint_count = 20;
  const std::vector<std::string> names = joint_orders().front().names();
  for (int joint = 0; joint < 22; ++joint) {
    if (joint != 10 && joint != 11) motion.names.push_back(names[joint]);
  }
  for (int frame = 0; frame < body.frame_count; ++frame) {
    for (int joint = 0; joint < 22; ++joint) {
      if (joint != 10 && joint != 11) motion.positions.push_back(body.position(frame, joint));
    }
  }
  const Clip clip = clip_of(motion);
  const int foot = joint_of(clip, "left_ankle");
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const Vector3d up = world_poses(clip, frame)[foot].rotation * Vector3d::UnitZ();
    const double tilt = std::acos(std::min(1.0, up.z())), shin = 0.5 * figures[frame].left_knee;
    if (shin < 0.55) EXPECT_LT(tilt, 0.02) << shin;
    if (shin > 1.25) EXPECT_GT(tilt, 1.0);
  }
  EXPECT_THAT(warnings_of(clip), HasSubstr("except feet that can stand, which are level"));
}

// The tree of joints with these names that lie on a line.
std::optional<JointTree> tree_of(const std::vector<std::string>& names) {
  JointMotion motion;
  motion.frame_count = 1;
  motion.joint_count = static_cast<int>(names.size());
  motion.positions.assign(names.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < names.size(); ++i) motion.positions[i].x() = 0.01 * (double)i;
  return joint_tree(motion, names);
}

// The toe of MediaPipe is called `foot_index`, that of OpenPose and Halpe `big_toe`.
TEST(JointTreeTest, KeypointsOfVideoHaveToes) {
  int orders = 0;
  for (const JointOrder& order : joint_orders()) {
    const std::vector<std::string> names = order.names();
    if (std::ranges::find(names, "left_heel") == names.end()) continue;
    ++orders;
    const auto tree = tree_of(names);
    ASSERT_TRUE(tree.has_value()) << order.name;
    for (const auto& [toe, ankle] : {std::pair(Bone::kLeftToe, Bone::kLeftFoot),
                                     std::pair(Bone::kRightToe, Bone::kRightFoot)}) {
      ASSERT_GE(tree->joint_of_bone[toe], 0) << order.name;
      EXPECT_EQ(tree->parents[tree->joint_of_bone[toe]], tree->joint_of_bone[ankle]);
    }
    // As the child of an ankle, a heel could be taken for the front of the foot.
    const auto heel = std::ranges::find(names, "left_heel") - names.begin();
    EXPECT_EQ(tree->parents[heel], tree->joint_of_bone[Bone::kLeftLeg]) << order.name;
  }
  EXPECT_EQ(orders, 3);
}

TEST(JointTreeTest, KnownJointOrdersFormBodies) {
  for (const JointOrder& order : joint_orders()) {
    const auto tree = tree_of(order.names());
    ASSERT_TRUE(tree.has_value()) << order.name;
    for (const Bone bone :
         {Bone::kHips, Bone::kSpine2, Bone::kHead, Bone::kLeftUpLeg, Bone::kRightLeg,
          Bone::kLeftFoot, Bone::kRightArm, Bone::kLeftForeArm, Bone::kRightHand}) {
      EXPECT_GE(tree->joint_of_bone[bone], 0) << order.name << " " << bone_name(bone);
    }
  }
  EXPECT_EQ(joint_orders()[7].joint_count(), 53U);
}

TEST(JointTreeTest, HandsFollowTheirKnuckles) {
  // Fingers of both hands below the wrists, palms down, then the left one rotated about the
  // forearm.
  JointMotion motion;
  motion.names = joint_orders()[5].names();
  motion.joint_count = static_cast<int>(motion.names.size());
  motion.frame_count = 2;
  const double turn = kPi / 3;
  for (const double left_turn : {0.0, turn}) {
    Figure figure;
    figure.left_elbow = figure.right_elbow = 0.8;
    const auto body = places_of(figure);
    motion.positions.insert(motion.positions.end(), body.begin(), body.end());
    for (const int side : {0, 1}) {
      const Vector3d wrist = body[side == 0 ? 20 : 21], elbow = body[side == 0 ? 18 : 19];
      const Vector3d out = (wrist - elbow).normalized();
      const Vector3d thumb_side =
          (out.cross(Vector3d::UnitZ()) * (side == 0 ? 1 : -1)).normalized();
      const Quaterniond twist = about(out, side == 0 ? left_turn : 0.0);
      for (const double across : {0.03, 0.01, -0.03, -0.01, 0.05}) {
        for (const double along : {0.09, 0.12, 0.14}) {
          motion.positions.push_back(wrist + along * out + twist * (across * thumb_side));
        }
      }
    }
  }
  const Clip clip = clip_of(motion);
  EXPECT_THAT(clip.origin().unknown_rotations, testing::ElementsAre("head"));
  EXPECT_NEAR(turn_between(clip, "left_wrist", 0, 1), turn, 0.02);
  EXPECT_NEAR(turn_between(clip, "right_wrist", 0, 1), 0.0, 1e-9);
}

}  // namespace
}  // namespace retarget
