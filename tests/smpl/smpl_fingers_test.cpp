// Fingers of SMPL+H and SMPL-X: read from any of their arrays if they move.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "formats/smpl/read_smpl.h"
#include "formats/smpl/smpl_body.h"
#include "retarget/clip.h"
#include "retarget/so3.h"
#include "smpl/smpl_test_support.h"
#include "support/load_smpl.h"
#include "support/value_of.h"

namespace retarget {
namespace {

constexpr std::size_t kHandFrames = 3;

using Arrays = std::vector<std::pair<std::string, std::string>>;

std::string file_of(Arrays arrays) {
  arrays.emplace_back("trans", npy_doubles({kHandFrames, 3}, std::vector<double>(3 * kHandFrames)));
  arrays.emplace_back("betas", npy_doubles({10}, std::vector<double>(10)));
  arrays.emplace_back("mocap_framerate", npy_doubles({}, {30.0}));
  arrays.emplace_back("gender", npy_text("neutral"));
  NpzBuilder builder;
  for (const auto& [name, bytes] : arrays) builder.add(name, bytes);
  return builder.build();
}

SmplMotion motion_with_hands(const std::string& bytes, const SmplBody* body = nullptr) {
  ArrayReadOptions options;
  options.body = body;
  return value_of(read_smpl(bytes, "fingers.npz", options));
}

// Whole poses with `hands` in the last 90 columns.
std::string whole(std::size_t width, const std::vector<double>& hands) {
  std::vector<double> poses(kHandFrames * width);
  for (std::size_t frame = 0; frame < kHandFrames; ++frame) {
    for (std::size_t i = 0; i < 90; ++i) {
      poses[frame * width + width - 90 + i] = hands[frame * 90 + i];
    }
  }
  return file_of({{"poses", npy_doubles({kHandFrames, width}, poses)}});
}

// The joint's rotation in the file, by its index in the hands.
Eigen::Quaterniond rotation_of(const std::vector<double>& hands, std::size_t frame,
                               std::size_t joint) {
  return exp_so3(Eigen::Map<const Eigen::Vector3d>(hands.data() + frame * 90 + 3 * joint));
}

void expect_fingers(const SmplMotion& motion, const std::vector<double>& hands) {
  const Skeleton& skeleton = motion.clip.skeleton();
  ASSERT_EQ(skeleton.joint_count(), 52);
  const std::pair<const char*, std::size_t> joints[] = {
      {"left_index1", 0},  {"left_middle2", 4},  {"left_pinky3", 8},   {"left_ring1", 9},
      {"left_thumb3", 14}, {"right_index1", 15}, {"right_thumb1", 27}, {"right_thumb3", 29}};
  for (const auto& [name, number] : joints) {
    const auto joint = skeleton.find(name);
    ASSERT_TRUE(joint) << name;
    for (std::size_t frame = 0; frame < kHandFrames; ++frame) {
      EXPECT_LT(motion.clip.rotations(static_cast<int>(frame))[static_cast<std::size_t>(*joint)]
                    .angularDistance(rotation_of(hands, frame, number)),
                1e-9)
          << name;
    }
  }
  EXPECT_EQ(skeleton.joint(skeleton.joint(*skeleton.find("left_thumb1")).parent).name,
            "left_wrist");
  EXPECT_EQ(skeleton.joint(skeleton.joint(*skeleton.find("right_ring3")).parent).name,
            "right_ring2");
}

TEST(SmplFingersTest, AreTheLastColumnsOfWholePoses) {
  const std::vector<double> hands = Numbers(1).list(kHandFrames * 90);
  for (const std::size_t width : {156, 165})
    expect_fingers(motion_with_hands(whole(width, hands)), hands);
}

TEST(SmplFingersTest, MayHaveSeparateArrays) {
  const std::vector<double> hands = Numbers(2).list(kHandFrames * 90);
  const Arrays body = {
      {"root_orient", npy_doubles({kHandFrames, 3}, std::vector<double>(3 * kHandFrames))},
      {"pose_body", npy_doubles({kHandFrames, 63}, std::vector<double>(63 * kHandFrames))}};
  Arrays together = body;
  together.emplace_back("pose_hand", npy_doubles({kHandFrames, 90}, hands));
  expect_fingers(motion_with_hands(file_of(together)), hands);
  std::vector<double> left, right;
  for (std::size_t frame = 0; frame < kHandFrames; ++frame) {
    const auto row = hands.begin() + static_cast<std::ptrdiff_t>(90 * frame);
    left.insert(left.end(), row, row + 45);
    right.insert(right.end(), row + 45, row + 90);
  }
  Arrays apart = body;
  apart.emplace_back("left_hand_pose", npy_doubles({kHandFrames, 45}, left));
  apart.emplace_back("right_hand_pose", npy_doubles({kHandFrames, 45}, right));
  expect_fingers(motion_with_hands(file_of(apart)), hands);
  // One hand alone; the other one rests.
  for (const bool is_left : {true, false}) {
    Arrays one = body;
    one.push_back(apart[apart.size() - (is_left ? 2 : 1)]);
    std::vector<double> expected = hands;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if ((i % 90 < 45) != is_left) expected[i] = 0.0;
    }
    const SmplMotion motion = motion_with_hands(file_of(one));
    expect_fingers(motion, expected);
    const bool is_told = std::ranges::any_of(motion.warnings, [&](const Warning& warning) {
      return warning.message ==
             (is_left ? "no right_hand_pose next to left_hand_pose: the fingers of the right hand "
                        "stay at rest"
                      : "no left_hand_pose next to right_hand_pose: the fingers of the left hand "
                        "stay at rest");
    });
    EXPECT_TRUE(is_told);
  }
}

TEST(SmplFingersTest, OfAHandDoNotDependOnTheOtherHand) {
  const std::vector<double> zeros(kHandFrames * 45);
  const std::vector<double> right = Numbers(8).list(kHandFrames * 45);
  std::vector<double> expected(kHandFrames * 90);
  for (std::size_t i = 0; i < right.size(); ++i) expected[i / 45 * 90 + 45 + i % 45] = right[i];
  std::vector<double> nan = right;
  nan[7] = std::nan("");
  const std::pair<std::string, const char*> others[] = {
      {npy_doubles({kHandFrames, 45}, zeros), nullptr},
      {npy_doubles({kHandFrames, 12}, std::vector<double>(kHandFrames * 12)), "found (3, 12)"},
      {npy_doubles({kHandFrames, 12}, Numbers(9).list(kHandFrames * 12)), "found (3, 12)"},
      {npy_doubles({1, 45}, std::vector<double>(45)), "found (1, 45)"},
      {npy_doubles({kHandFrames, 45}, nan), "has values that are not rotations"},
      {npy("|O", "()", "never read"), "Python object"}};
  for (const auto& [left, fault] : others) {
    const SmplMotion motion = motion_with_hands(
        file_of({{"poses", npy_doubles({kHandFrames, 72}, std::vector<double>(kHandFrames * 72))},
                 {"left_hand_pose", left},
                 {"right_hand_pose", npy_doubles({kHandFrames, 45}, right)}}));
    expect_fingers(motion, expected);
    std::string ignored;
    for (const Warning& warning : motion.warnings) {
      if (warning.message.starts_with("fingers ignored")) ignored += warning.message;
    }
    if (fault == nullptr) {
      EXPECT_EQ(ignored, "");
    } else {
      EXPECT_NE(ignored.find("left_hand_pose"), std::string::npos) << ignored;
      EXPECT_NE(ignored.find(fault), std::string::npos) << ignored;
    }
  }
}

TEST(SmplFingersTest, IgnoresOtherColumns) {
  const auto joints = [](const std::string& bytes) {
    return motion_with_hands(bytes).clip.skeleton().joint_count();
  };
  std::vector<double> hands = Numbers(3).list(kHandFrames * 90);
  EXPECT_EQ(joints(whole(156, std::vector<double>(kHandFrames * 90))), 22) << "zeros";
  std::vector<double> still;
  for (std::size_t frame = 0; frame < kHandFrames; ++frame) {
    still.insert(still.end(), hands.begin(), hands.begin() + 90);
  }
  EXPECT_EQ(joints(whole(165, still)), 22) << "they keep still";
  const Arrays components = {
      {"global_orient", npy_doubles({kHandFrames, 3}, std::vector<double>(3 * kHandFrames))},
      {"body_pose", npy_doubles({kHandFrames, 63}, std::vector<double>(63 * kHandFrames))},
      {"left_hand_pose", npy_doubles({kHandFrames, 12}, Numbers(4).list(12 * kHandFrames))},
      {"right_hand_pose", npy_doubles({kHandFrames, 12}, Numbers(5).list(12 * kHandFrames))}};
  const SmplMotion reduced = motion_with_hands(file_of(components));
  EXPECT_EQ(reduced.clip.skeleton().joint_count(), 22) << "principal components";
  ASSERT_FALSE(reduced.warnings.empty());
  const bool is_told = std::ranges::any_of(reduced.warnings, [](const Warning& warning) {
    return warning.message.find("fingers ignored: expected left_hand_pose") != std::string::npos;
  });
  EXPECT_TRUE(is_told);
  hands[7] = std::nan("");
  const SmplMotion odd = motion_with_hands(whole(156, hands));
  EXPECT_EQ(odd.clip.skeleton().joint_count(), 22);
  ASSERT_FALSE(odd.warnings.empty());
  EXPECT_NE(odd.warnings.back().message.find("fingers"), std::string::npos);
}

TEST(SmplFingersTest, DoNotChangeTheBody) {
  const std::vector<double> hands = Numbers(6).list(kHandFrames * 90);
  const SmplMotion with = motion_with_hands(whole(156, hands));
  const SmplMotion without = motion_with_hands(whole(156, std::vector<double>(kHandFrames * 90)));
  for (int joint = 0; joint < without.clip.skeleton().joint_count(); ++joint) {
    const Joint& plain = without.clip.skeleton().joint(joint);
    const auto same = with.clip.skeleton().find(plain.name);
    ASSERT_TRUE(same);
    EXPECT_EQ(with.clip.skeleton().joint(*same).offset, plain.offset);
    EXPECT_EQ(with.clip.skeleton().joint(*same).end_sites, plain.end_sites);
  }
}

TEST(SmplFingersTest, UseTheBonesOfAModel) {
  const MadeUpModel model(55, 2);
  const auto body = value_of(read_smpl_body(model.bytes(), "model.npz"));
  const SmplRestBody rest = smpl_rest_body(body, {});
  ASSERT_EQ(rest.hands.size(), 30U);
  const SmplMotion motion = motion_with_hands(whole(165, Numbers(7).list(kHandFrames * 90)), &body);
  const Skeleton& skeleton = motion.clip.skeleton();
  const Joint& index = skeleton.joint(*skeleton.find("left_index2"));
  EXPECT_LT((index.offset - (rest.hands[1] - rest.hands[0])).norm(), 1e-12);
  const Joint& knuckle = skeleton.joint(*skeleton.find("right_index1"));
  EXPECT_LT((knuckle.offset - (rest.hands[15] - rest.joints[21])).norm(), 1e-12);
}

}  // namespace
}  // namespace retarget
