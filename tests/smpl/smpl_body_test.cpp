#include "formats/smpl/smpl_body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "smpl_test_support.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

Eigen::Vector3d joint_named(const SmplRestBody& body, std::string_view name) {
  const auto place = std::ranges::find(kSmplJointNames, name);
  EXPECT_NE(place, kSmplJointNames.end()) << name;
  return body.joints[static_cast<std::size_t>(place - kSmplJointNames.begin())];
}

TEST(SmplJoints, ParentsComeFirstAndSidesMirror) {
  for (int joint = 1; joint < kSmplJointCount; ++joint) {
    ASSERT_GE(kSmplParents[joint], 0);
    ASSERT_LT(kSmplParents[joint], joint);
    std::string name(kSmplJointNames[joint]);
    if (!name.starts_with("left_")) continue;
    name.replace(0, 5, "right_");
    EXPECT_EQ(kSmplJointNames[joint + 1], name);
  }
}

TEST(GenericBody, StandsInATPoseWithTheProportionsOfAnAdult) {
  const double height = 1.8;
  const SmplRestBody body = generic_smpl_rest_body(height);
  EXPECT_EQ(body.height, height);
  EXPECT_EQ(joint_named(body, "pelvis"), Eigen::Vector3d::Zero());

  // Drillis and Contini: heights above the floor.
  const double floor = body.tips[kHeadTop].y() - height;
  const auto share = [&](std::string_view name) {
    return (joint_named(body, name).y() - floor) / height;
  };
  EXPECT_NEAR(share("left_ankle"), 0.039, 1e-12);
  EXPECT_NEAR(share("left_knee"), 0.285, 1e-12);
  EXPECT_NEAR(share("left_hip"), 0.530, 1e-12);
  EXPECT_NEAR(share("left_shoulder"), 0.818, 1e-12);
  EXPECT_GT(body.tips[kLeftToes].y(), floor);

  // Proportions of every adult: a span close to the height, forearms shorter than upper arms.
  const double span = body.tips[kLeftFingers].x() - body.tips[kRightFingers].x();
  EXPECT_NEAR(span / height, 1.03, 0.03);
  const double upper = joint_named(body, "left_elbow").x() - joint_named(body, "left_shoulder").x();
  const double lower = joint_named(body, "left_wrist").x() - joint_named(body, "left_elbow").x();
  EXPECT_GT(upper, lower);
  // It faces z, as do its feet.
  EXPECT_GT(body.tips[kLeftToes].z(), joint_named(body, "left_foot").z());
  EXPECT_GT(joint_named(body, "left_foot").z(), joint_named(body, "left_ankle").z());
}

TEST(GenericBody, IsSymmetricAndScalesWithHeight) {
  const SmplRestBody body = generic_smpl_rest_body(1.5);
  const SmplRestBody twice = generic_smpl_rest_body(3.0);
  const Eigen::Vector3d mirror(-1, 1, 1);
  for (int joint = 0; joint < kSmplJointCount; ++joint) {
    EXPECT_TRUE(twice.joints[joint].isApprox(2.0 * body.joints[joint], 1e-12) || joint == 0);
    if (!kSmplJointNames[joint].starts_with("left_")) continue;
    EXPECT_GT(body.joints[joint].x(), 0.0) << kSmplJointNames[joint];
    EXPECT_EQ(body.joints[joint].cwiseProduct(mirror), body.joints[joint + 1]);
  }
}

TEST(SmplSkeleton, IsDepthFirstAndItsZeroPoseIsTheRestBody) {
  SmplRestBody body = generic_smpl_rest_body(1.7);
  for (Eigen::Vector3d& joint : body.joints) joint += Eigen::Vector3d(0.1, -0.2, 0.3);
  const auto skeleton = smpl_skeleton(body);
  ASSERT_EQ(skeleton->joint_count(), kSmplJointCount);
  const Clip clip(skeleton, FrameRate{}, 1);
  std::vector<Pose> world(kSmplJointCount);
  forward_kinematics(clip, 0, world);
  for (int place = 0; place < kSmplJointCount; ++place) {
    const int joint = smpl_skeleton_order()[place];
    const Joint& found = skeleton->joint(place);
    EXPECT_EQ(found.name, kSmplJointNames[joint]);
    EXPECT_LT((world[place].translation - body.joints[joint]).norm(), 1e-12) << found.name;
    EXPECT_EQ(found.has_position_channels(), place == 0);
    if (place == 0) continue;
    EXPECT_EQ(skeleton->joint(found.parent).name, kSmplJointNames[kSmplParents[joint]]);
    // Depth first: the parent is the previous joint or one of its ancestors.
    int ancestor = place - 1;
    while (ancestor >= 0 && ancestor != found.parent) ancestor = skeleton->joint(ancestor).parent;
    EXPECT_EQ(ancestor, found.parent) << found.name;
  }
  const Joint& head = skeleton->joint(*skeleton->find("head"));
  ASSERT_EQ(head.end_sites.size(), 1U);
  EXPECT_TRUE(head.end_sites[0].isApprox(body.tips[kHeadTop] - joint_named(body, "head")));
  EXPECT_EQ(skeleton->joint(*skeleton->find("left_foot")).end_sites.size(), 1U);
  EXPECT_TRUE(skeleton->joint(*skeleton->find("left_knee")).end_sites.empty());
}

SmplBody body_of(const MadeUpModel& model) {
  return value_of(read_smpl_body(model.bytes(), "model.npz"));
}

TEST(SmplBody, JointsAreRegressedFromTheShapedMesh) {
  const MadeUpModel model(24, 3);
  const SmplBody body = body_of(model);
  EXPECT_EQ(body.family, SmplFamily::kSmpl);
  EXPECT_EQ(body.beta_count(), 3);
  for (const std::vector<double>& betas : {std::vector<double>{}, {1.5, -0.5, 2.0}, {0.0, 3.0}}) {
    const SmplRestBody rest = smpl_rest_body(body, betas);
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      const Eigen::Vector3d expected = model.joint(static_cast<std::size_t>(joint), betas);
      EXPECT_LT((rest.joints[joint] - expected).norm(), 1e-12) << kSmplJointNames[joint];
    }
    for (int tip = 0; tip < kSmplTipCount; ++tip) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(rest.tips[tip][axis], model.shaped(tip, axis, betas), 1e-12);
      }
    }
    EXPECT_NEAR(rest.height, model.shaped(0, 1, betas) - model.shaped(5, 1, betas), 1e-12);
  }
}

TEST(SmplBody, IgnoresExtraBetas) {
  const SmplBody body = body_of(MadeUpModel(52, 3));
  EXPECT_EQ(smpl_rest_body(body, std::vector<double>{1, 2, 3, 4, 5}).joints,
            smpl_rest_body(body, std::vector<double>{1, 2, 3}).joints);
}

TEST(SmplBody, IgnoresFaceShapes) {
  const auto betas = [](std::size_t joints, std::size_t columns) {
    return body_of(MadeUpModel(joints, columns)).beta_count();
  };
  EXPECT_EQ(betas(55, 20), 10);
  EXPECT_EQ(betas(55, 8), 8);
  EXPECT_EQ(betas(55, 400), 300);
  EXPECT_EQ(betas(52, 16), 16);
  EXPECT_EQ(body_of(MadeUpModel(55, 20)).family, SmplFamily::kSmplx);
}

std::string body_error(const std::string& bytes) {
  const Result<SmplBody> body = read_smpl_body(bytes, "model.npz");
  if (body) return "no error";
  EXPECT_EQ(body.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(body.error().location.file, "model.npz");
  return describe(body.error());
}

TEST(SmplBody, RejectsOtherFiles) {
  EXPECT_THAT(body_error("\x80\x02}q\x01"), HasSubstr("found a Python pickle"));
  EXPECT_THAT(body_error("\x80\x02}q\x01"), HasSubstr("J_regressor (as a dense array)"));
  EXPECT_THAT(body_error("(dp0\nS'J'\n"), HasSubstr("found a Python pickle"));
  EXPECT_THAT(body_error(NpzBuilder().add("poses", npy_doubles({1, 72}, {})).build()),
              HasSubstr("expected a body model, found a motion"));
  for (const char* name : {"v_template", "shapedirs", "J_regressor", "kintree_table"}) {
    EXPECT_THAT(body_error(MadeUpModel(24, 3).builder_without(name).build()),
                HasSubstr("no array \"" + std::string(name) + "\""));
  }
}

TEST(SmplBody, RejectsInconsistentArrays) {
  const MadeUpModel model(24, 3);
  const auto with = [&](const std::string& name, const std::string& bytes) {
    return body_error(model.builder_without(name).add(name, bytes).build());
  };
  EXPECT_THAT(
      with("J_regressor", npy("|O", "()", "sparse")),
      HasSubstr("array \"J_regressor\": it contains Python objects (perhaps a sparse matrix)"));
  EXPECT_THAT(with("J_regressor", npy_doubles({24, 2}, std::vector<double>(48))),
              HasSubstr("expected numbers of shape (any, 40), found (24, 2)"));
  EXPECT_THAT(with("v_template", npy_doubles({120}, model.vertices)),
              HasSubstr("expected numbers of shape (any, 3), found (120,)"));
  EXPECT_THAT(with("v_template", npy_doubles({0, 3}, {})), HasSubstr("found (0, 3)"));
  EXPECT_THAT(with("shapedirs", npy_doubles({40, 3, 0}, {})), HasSubstr("found (40, 3, 0)"));
  EXPECT_THAT(with("shapedirs", npy_text("neutral")), HasSubstr("found text of ()"));

  std::vector<double> values = model.vertices;
  values[17] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(with("v_template", npy_doubles({40, 3}, values)), HasSubstr("not finite"));
  values = model.vertices;
  for (double& value : values) value *= 100.0;
  EXPECT_THAT(with("v_template", npy_doubles({40, 3}, values)),
              HasSubstr("170.000000 high along y is not in metres"));
  values = model.vertices;
  for (std::size_t i = 0; i < values.size(); i += 3) values[i] = std::abs(values[i]) + 0.1;
  EXPECT_THAT(with("v_template", npy_doubles({40, 3}, values)), HasSubstr("on one side of x = 0"));
}

TEST(SmplBody, RejectsOtherKinematicTrees) {
  MadeUpModel hand(16, 3);
  EXPECT_THAT(body_error(hand.bytes()), HasSubstr("joints do not match SMPL"));
  MadeUpModel swapped(24, 3);
  std::swap(swapped.tree[4], swapped.tree[5]);
  EXPECT_THAT(body_error(swapped.bytes()), HasSubstr("joints do not match SMPL"));
}

TEST(SmplBody, LoadsAFile) {
  const TemporaryFolder folder;
  const std::string path = folder.write("model.npz", MadeUpModel(24, 3).bytes());
  const auto body = value_of(load_smpl_body(path));
  EXPECT_EQ(body.file, path);
  const Result<SmplBody> missing = load_smpl_body(path + "x");
  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().kind, ErrorKind::kConfig);
}

}  // namespace
}  // namespace retarget
