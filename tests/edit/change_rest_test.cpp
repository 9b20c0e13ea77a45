
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "retarget/clip.h"
#include "retarget/edit.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

std::mt19937& generator() {
  static std::mt19937 random(9);
  return random;
}

Eigen::Vector3d random_vector() {
  std::normal_distribution<double> normal;
  return {normal(generator()), normal(generator()), normal(generator())};
}

Eigen::Quaterniond random_turn() {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(generator()), normal(generator()), normal(generator()),
                            normal(generator()))
      .normalized();
}

Joint joint(const std::string& name, int parent, const Eigen::Vector3d& offset) {
  Joint result;
  result.name = name;
  result.parent = parent;
  result.offset = offset;
  result.channels = {Channel::kZRotation, Channel::kYRotation, Channel::kXRotation};
  return result;
}

// A trunk with two arms of three joints each, moving at random.
Clip body() {
  std::vector<Joint> joints = {
      joint("hips", -1, {0, 0, 0}),      joint("chest", 0, {0, 3, 0.2}),
      joint("l_arm", 1, {1, 1, 0}),      joint("l_elbow", 2, {2, 0, 0}),
      joint("l_hand", 3, {1.5, 0, 0.1}), joint("r_arm", 1, {-1, 1, 0}),
      joint("r_elbow", 5, {-2, 0, 0}),   joint("r_hand", 6, {-1.5, 0, 0.1})};
  joints[0].channels.insert(joints[0].channels.begin(),
                            {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition});
  joints[4].end_sites = {{0.5, 0.1, 0}};
  joints[7].end_sites = {{-0.5, 0.1, 0}};
  Clip clip(std::make_shared<const Skeleton>(joints), FrameRate{30, 1}, 20);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (auto& rotation : clip.rotations(frame)) rotation = random_turn();
    clip.translations(frame)[0] = random_vector();
  }
  return clip;
}

// The same bones with randomly rotated joint axes: another rest pose.
std::shared_ptr<const Skeleton> with_other_rest(const Skeleton& skeleton, bool rigid) {
  std::vector<Joint> joints = skeleton.joints();
  std::vector<Eigen::Quaterniond> turns;
  for (std::size_t i = 0; i < joints.size(); ++i) turns.push_back(random_turn());
  for (Joint& joint : joints) {
    const std::size_t self = static_cast<std::size_t>(&joint - joints.data());
    if (joint.parent >= 0) joint.offset = turns[joint.parent] * joint.offset;
    for (Eigen::Vector3d& site : joint.end_sites) site = turns[self] * site;
  }
  // Bones that leave one joint at different angles cannot be aligned.
  if (!rigid) {
    Eigen::Vector3d& arm = joints[2].offset;
    const Eigen::Vector3d axis = arm.cross(joints[5].offset).normalized();
    arm = Eigen::AngleAxisd(1.0, axis) * arm;
  }
  return std::make_shared<const Skeleton>(joints);
}

// The left arm is declared right before the left.
std::shared_ptr<const Skeleton> reordered(const Skeleton& skeleton) {
  const std::vector<int> order = {0, 1, 5, 6, 7, 2, 3, 4};
  std::vector<Joint> joints;
  for (const int index : order) {
    Joint joint = skeleton.joint(index);
    if (joint.parent >= 0) {
      joint.parent = static_cast<int>(std::ranges::find(order, joint.parent) - order.begin());
    }
    joints.push_back(joint);
  }
  return std::make_shared<const Skeleton>(joints);
}

double largest_gap(const Clip& a, const Clip& b) {
  std::vector<Pose> in_a(a.skeleton().joint_count()), in_b(b.skeleton().joint_count());
  double largest = 0.0;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    forward_kinematics(a, frame, in_a);
    forward_kinematics(b, frame, in_b);
    for (int i = 0; i < a.skeleton().joint_count(); ++i) {
      const int twin = *b.skeleton().find(a.skeleton().joint(i).name);
      largest = std::max(largest, (in_a[i].translation - in_b[twin].translation).norm());
    }
  }
  return largest;
}

TEST(ChangeRest, KeepsJointPositions) {
  for (int round = 0; round < 50; ++round) {
    const Clip clip = body();
    const auto target = reordered(*with_other_rest(clip.skeleton(), true));
    const auto changed = value_of(change_rest(clip, target, "a.bvh", "t.bvh"));
    EXPECT_LT(largest_gap(clip, changed.clip), 1e-9);
    EXPECT_LT(changed.largest_distance, 1e-9);
    // Back again.
    const auto back = value_of(change_rest(changed.clip, clip.shared_skeleton(), "t.bvh", "a.bvh"));
    EXPECT_LT(largest_gap(clip, back.clip), 1e-9);
  }
}

TEST(ChangeRest, SameSkeletonIsIdentity) {
  const Clip clip = body();
  const auto changed = change_rest(clip, clip.shared_skeleton(), "a.bvh", "a.bvh").value();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (int i = 0; i < clip.skeleton().joint_count(); ++i) {
      const auto& before = clip.rotations(frame)[i];
      const auto& after = std::as_const(changed.clip).rotations(frame)[i];
      EXPECT_GT(std::abs(before.dot(after)), 1.0 - 1e-14);
    }
  }
}

TEST(ChangeRest, ReportsTheLargestDistance) {
  const Clip clip = body();
  const auto target = with_other_rest(clip.skeleton(), false);
  const auto changed = change_rest(clip, target, "a.bvh", "t.bvh").value();
  EXPECT_GT(changed.largest_distance, 0.1);
  EXPECT_NEAR(changed.largest_distance,
              std::max(changed.largest_distance, largest_gap(clip, changed.clip)), 1e-12);
}

TEST(ChangeRest, RejectsDifferentTrees) {
  const Clip clip = body();
  std::vector<Joint> joints = clip.skeleton().joints();
  joints[3].name = "l_elbw";
  const auto renamed = change_rest(clip, std::make_shared<const Skeleton>(joints), "a", "t");
  ASSERT_FALSE(renamed);
  EXPECT_THAT(renamed.error().message, HasSubstr("l_elbow"));
  joints = clip.skeleton().joints();
  joints.pop_back();
  EXPECT_FALSE(change_rest(clip, std::make_shared<const Skeleton>(joints), "a", "t"));
  joints = clip.skeleton().joints();
  joints[5].parent = 0;
  EXPECT_FALSE(change_rest(clip, std::make_shared<const Skeleton>(joints), "a", "t"));
  joints = clip.skeleton().joints();
  joints[5].name = "l_arm";
  EXPECT_FALSE(change_rest(clip, std::make_shared<const Skeleton>(joints), "a", "t"));
}

}  // namespace
}  // namespace retarget
