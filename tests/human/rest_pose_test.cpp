#include "human/skeleton/rest_pose.h"

#include <gtest/gtest.h>

#include "human/hand_made_maps.h"
#include "retarget/human_skeleton.h"

namespace retarget {
namespace {

// y up, facing z: two arms with directions given for the left side.
Skeleton person(const Eigen::Vector3d& upper, const Eigen::Vector3d& lower) {
  std::vector<Joint> joints;
  const auto add = [&](const std::string& name, int parent, const Eigen::Vector3d& offset) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.offset = offset;
    joints.push_back(joint);
    return static_cast<int>(joints.size()) - 1;
  };
  const int hips = add("Hips", -1, {0, 0.9, 0});
  const int torso = add("Spine2", hips, {0, 0.3, 0});
  add("Head", add("Neck", torso, {0, 0.25, 0}), {0, 0.1, 0});
  for (const std::string side : {"Left", "Right"}) {
    const Eigen::Vector3d out(side == "Left" ? 1 : -1, 1, 1);
    int leg = add(side + "UpLeg", hips, out.cwiseProduct(Eigen::Vector3d(0.1, 0, 0)));
    leg = add(side + "Leg", leg, {0, -0.42, 0});
    leg = add(side + "Foot", leg, {0, -0.42, 0});
    add(side + "Toe", leg, {0, -0.06, 0.14});
    int arm = add(side + "Arm", torso, out.cwiseProduct(Eigen::Vector3d(0.2, 0.2, 0)));
    arm = add(side + "ForeArm", arm, out.cwiseProduct(upper));
    add(side + "Hand", arm, out.cwiseProduct(lower));
  }
  return Skeleton(joints);
}

RestCandidate zero_of(const Body& body) {
  RestCandidate candidate;
  candidate.pose = zero_pose(body.skeleton());
  candidate.axes = body_axes(body, candidate.pose, Eigen::Vector3d::UnitY()).value();
  candidate.is_built = true;
  return candidate;
}

TEST(RestPose, MeasuresDeviationFromTheTPose) {
  const Skeleton t = person({0.3, 0, 0}, {0.25, 0, 0});
  const Body t_body(t, lafan1_map(t, "test"));
  EXPECT_LT(deviation_from_t(t_body, zero_of(t_body)).mean, 1e-9);
  EXPECT_TRUE(is_well_formed(t_body, zero_of(t_body)));
  // An A-pose: four of nine directions are 45 degrees off.
  const Skeleton a = person({0.2, -0.2, 0}, {0.2, -0.2, 0});
  const Body a_body(a, lafan1_map(a, "test"));
  EXPECT_NEAR(deviation_from_t(a_body, zero_of(a_body)).mean, 20.0, 1e-9);
  EXPECT_NEAR(deviation_from_t(a_body, zero_of(a_body)).largest, 45.0, 1e-9);
  EXPECT_TRUE(is_well_formed(a_body, zero_of(a_body)));
}

TEST(RestPose, RejectsImplausibleArms) {
  const Eigen::Vector3d left(0.3, 0, 0), up(0, 0.3, 0), ahead(0, 0, 0.3);
  for (const auto& [upper, lower] :
       {std::pair(up, up), std::pair(ahead, ahead), std::pair(left, ahead)}) {
    const Skeleton skeleton = person(upper, lower);
    const Body body(skeleton, lafan1_map(skeleton, "test"));
    EXPECT_FALSE(is_well_formed(body, zero_of(body)));
  }
}

// Raising a straight arm about the forward axis keeps its twist: palms that face the thighs face
// down in the T-pose.
TEST(RestPose, RaisesArmsAboutTheForwardAxis) {
  const Skeleton skeleton = person({0, -0.3, 0}, {0, -0.25, 0});
  const Body body(skeleton, lafan1_map(skeleton, "test"));
  const JointFromBone axes = bring_to_t(body, zero_of(body));
  // World axes of the canonical hanging arm: X down, Y back, and Z, which points up in the T-pose,
  // outward.
  for (const char* bone : {"LeftArm", "LeftForeArm", "LeftHand"}) {
    const Eigen::Matrix3d& hanging = *axes[*bone_from_name(bone)];
    EXPECT_LT((hanging.col(0) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12) << bone;
    EXPECT_LT((hanging.col(1) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12) << bone;
    EXPECT_LT((hanging.col(2) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12) << bone;
  }
}

TEST(LeastRotation, MapsOneDirectionToTheOther) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d oblique = Eigen::Vector3d(1, -2, 3).normalized();
  for (const Eigen::Vector3d& target : {x, y, oblique, Eigen::Vector3d(-x)}) {
    const Eigen::Matrix3d turn = minimal_rotation(x, target, y);
    EXPECT_LT((turn * x - target).norm(), 1e-14);
    EXPECT_NEAR(turn.determinant(), 1.0, 1e-14);
    EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), std::acos(x.dot(target)), 1e-7);
  }
}

}  // namespace
}  // namespace retarget
