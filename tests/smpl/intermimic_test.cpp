#include "formats/smpl/motion_arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "formats/smpl/read_smpl.h"
#include "motion_parts.h"
#include "retarget/clip.h"
#include "retarget/so3.h"
#include "support/load_smpl.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

// A body with unusual bone lengths and no limb exactly along an axis.
SmplRestBody crooked_body() {
  SmplRestBody body = generic_smpl_rest_body(1.8);
  Numbers numbers(31);
  for (std::size_t i = 1; i < body.joints.size(); ++i) {
    body.joints[i] += 0.02 * Eigen::Vector3d(numbers.next(), numbers.next(), numbers.next());
  }
  return body;
}

// Bodies of InterMimic's model: their index in kSmplJointNames, -1: a finger.
std::vector<int> joint_of_body() {
  std::vector<int> joints = {0, 1, 4, 7, 10, 2, 5, 8, 11, 3, 6, 9, 12, 15, 13, 16, 18, 20};
  joints.insert(joints.end(), 15, -1);
  for (const int joint : {14, 17, 19, 21}) joints.push_back(joint);
  joints.insert(joints.end(), 15, -1);
  return joints;
}

// A motion in InterMimic's columns, from its arrays and body by the models' own recursion.
std::vector<float> intermimic_rows(const Parts& parts, const SmplRestBody& body) {
  // x forward, y to the left, z up from x left, y up, z forward.
  const auto turned = [](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.z(), v.x(), v.y()); };
  const Eigen::Quaterniond smpl_from_body(0.5, -0.5, -0.5, -0.5);
  const std::vector<int> order = joint_of_body();
  std::vector<float> rows(kPartFrames * 591, 0.0F);
  for (std::size_t frame = 0; frame < kPartFrames; ++frame) {
    float* row = rows.data() + 591 * frame;
    const auto put = [&](std::size_t column, const Eigen::Vector3d& v) {
      for (int axis = 0; axis < 3; ++axis) row[column + axis] = static_cast<float>(v[axis]);
    };
    const auto local = [&](int joint) {
      return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(
          joint == 0 ? parts.root.data() + 3 * frame
                     : parts.body.data() + 63 * frame + 3 * (joint - 1)));
    };
    std::vector<Eigen::Quaterniond> world(kSmplJointCount);
    std::vector<Eigen::Vector3d> place(kSmplJointCount);
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      const int parent = kSmplParents[joint];
      const Eigen::Quaterniond rotation = exp_so3(local(joint));
      world[joint] = parent < 0 ? rotation : world[parent] * rotation;
      place[joint] =
          parent < 0
              ? Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(parts.trans.data() + 3 * frame))
              : place[parent] + world[parent] * (body.joints[joint] - body.joints[parent]);
    }
    const Eigen::Quaterniond root = world[0] * smpl_from_body;
    put(0, place[0]);
    put(3, root.vec());
    row[6] = static_cast<float>(root.w());
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (order[i] > 0) put(9 + 3 * (i - 1), turned(local(order[i])));
      if (order[i] >= 0) put(162 + 3 * i, place[order[i]]);
    }
  }
  return rows;
}

std::string intermimic_file(const std::vector<float>& rows) {
  TorchBuilder builder;
  return builder.build(builder.floats({static_cast<std::int64_t>(rows.size() / 591), 591}, rows));
}

TEST(InterMimicTest, InterMimicsMotionsHaveTheirOwnBones) {
  Parts parts;
  parts.betas = {0};
  const SmplRestBody body = crooked_body();
  const std::vector<float> rows = intermimic_rows(parts, body);
  const SmplMotion found = motion_of(intermimic_file(rows));
  const SmplMotion expected = motion_of(parts.npz());
  EXPECT_FALSE(found.approximate_body);
  EXPECT_EQ(found.clip.rate(), (FrameRate{30, 1}));
  EXPECT_THAT(warnings_of(found), HasSubstr("assuming InterMimic's 30 fps"));
  std::vector<Pose> poses(kSmplJointCount);
  for (int frame = 0; frame < found.clip.frame_count(); ++frame) {
    for (int joint = 0; joint < kSmplJointCount; ++joint) {
      EXPECT_LT(
          found.clip.rotations(frame)[joint].angularDistance(expected.clip.rotations(frame)[joint]),
          1e-6);
    }
    // Every position in the file.
    forward_kinematics(found.clip, frame, poses);
    const std::vector<int> order = joint_of_body();
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (order[i] < 0) continue;
      const float* place = rows.data() + 591 * frame + 162 + 3 * i;
      const int joint = *found.clip.skeleton().find(kSmplJointNames[order[i]]);
      EXPECT_LT((poses[joint].translation - Eigen::Vector3d(place[0], place[1], place[2])).norm(),
                2e-6);
    }
  }
  // A model without betas would be another person's.
  const auto model = value_of(read_smpl_body(MadeUpModel(55, 3).bytes(), "smplx.npz"));
  ArrayReadOptions options;
  options.body = &model;
  expect_same_motion(motion_of(intermimic_file(rows), options), found);
}

TEST(InterMimicTest, FingersFollowTheirWrists) {
  std::vector<float> rows = intermimic_rows(Parts(), crooked_body());
  // x forward, y left, z up: the first joint of the left index finger and the last of the right
  // thumb.
  for (std::size_t frame = 0; frame < kPartFrames; ++frame) {
    const float angle = 0.1F * static_cast<float>(frame);
    rows[591 * frame + 9 + 3 * 17] = angle;
    rows[591 * frame + 9 + 3 * 50 + 1] = angle;
  }
  const SmplMotion motion = motion_of(intermimic_file(rows));
  const Skeleton& skeleton = motion.clip.skeleton();
  ASSERT_EQ(skeleton.joint_count(), 52);
  const auto turn = [&](const char* name) {
    return log_so3(motion.clip.rotations(2)[static_cast<std::size_t>(*skeleton.find(name))]);
  };
  // The models' axes: x left, y up, z forward.
  EXPECT_LT((turn("left_index1") - Eigen::Vector3d(0, 0, 0.2)).norm(), 1e-6);
  EXPECT_LT((turn("right_thumb3") - Eigen::Vector3d(0.2, 0, 0)).norm(), 1e-6);
  EXPECT_LT(turn("left_thumb1").norm(), 1e-6);
}

TEST(InterMimicTest, RejectsOtherTensorsOfTheSameWidth) {
  const std::vector<float> rows = intermimic_rows(Parts(), crooked_body());
  const auto with = [&](std::size_t at, float value) {
    std::vector<float> changed = rows;
    changed[at] = value;
    return error_of(intermimic_file(changed));
  };
  EXPECT_THAT(with(591 + 20, std::nanf("")), HasSubstr("NaN in frame 1, column 20"));
  EXPECT_THAT(with(162 + 3, HUGE_VALF), HasSubstr("infinity in frame 0, column 165"));
  EXPECT_THAT(with(3 * 591 + 6, 3.0F),
              HasSubstr("columns 3 to 6 of frame 3 are not a unit quaternion"));
  EXPECT_THAT(with(2 * 591 + 162 + 6, 1.0F), HasSubstr("bone offsets vary by up to"));
  EXPECT_THAT(with(0, 4.0F), HasSubstr("bone offsets vary by up to"));
  EXPECT_THAT(error_of(intermimic_file({})), HasSubstr("has no frames"));
  // Column 320 is not read.
  EXPECT_EQ(with(320, std::nanf("")), "no error");
  std::vector<float> large = intermimic_rows(Parts(), generic_smpl_rest_body(180));
  EXPECT_THAT(error_of(intermimic_file(large)), HasSubstr("do not form a body in metres"));
}

TEST(InterMimicTest, RestOffsetsDefineTheBody) {
  const Parts parts;
  const SmplRestBody body = crooked_body();
  std::vector<double> offsets(72, 0.25);
  for (int joint = 1; joint < kSmplJointCount; ++joint) {
    const Eigen::Vector3d offset = body.joints[joint] - body.joints[kSmplParents[joint]];
    std::copy_n(offset.data(), 3, offsets.begin() + 3 * joint);
  }
  const auto with = [&](const std::string& name, const std::string& array, bool has_betas = false) {
    NpzBuilder builder;
    builder.add("root_orient", npy_doubles({kPartFrames, 3}, parts.root));
    builder.add("pose_body", npy_doubles({kPartFrames, 63}, parts.body));
    builder.add("trans", npy_doubles({kPartFrames, 3}, parts.trans));
    builder.add("trans2joint", npy_doubles({3}, {0, 0, 0}));
    if (has_betas) builder.add("betas", npy_doubles({3}, parts.betas));
    builder.add(name, array);
    return builder.build();
  };
  const SmplMotion found = motion_of(with("rest_offsets", npy_doubles({24, 3}, offsets)));
  EXPECT_FALSE(found.approximate_body);
  EXPECT_THAT(warnings_of(found), HasSubstr("assuming 30 fps, as in OMOMO"));
  const Skeleton& skeleton = found.clip.skeleton();
  for (int joint = 1; joint < kSmplJointCount; ++joint) {
    const Eigen::Vector3d offset = body.joints[joint] - body.joints[kSmplParents[joint]];
    EXPECT_LT((skeleton.joint(*skeleton.find(kSmplJointNames[joint])).offset - offset).norm(),
              1e-12);
  }
  EXPECT_NEAR(found.height, 1.8, 0.05);
  EXPECT_EQ(found.clip.translation(0, 0),
            Eigen::Vector3d(parts.trans[0], parts.trans[1], parts.trans[2]));
  // Betas of the user's own model provide more information.
  const auto model = value_of(read_smpl_body(MadeUpModel(24, 3).bytes(), "smpl.npz"));
  ArrayReadOptions options;
  options.body = &model;
  const std::string both = with("rest_offsets", npy_doubles({24, 3}, offsets), true);
  EXPECT_NE(motion_of(both, options).height, found.height);

  EXPECT_THAT(error_of(with("rest_offsets", npy_doubles({2, 3}, std::vector<double>(6)))),
              HasSubstr("rest_offsets\": expected numbers of shape (22 or more, 3), found (2, 3)"));
  for (double& value : offsets) value *= 100.0;
  EXPECT_THAT(error_of(with("rest_offsets", npy_doubles({24, 3}, offsets))),
              HasSubstr("the offsets do not form a body"));
  offsets[4] = std::nan("");
  EXPECT_THAT(error_of(with("rest_offsets", npy_doubles({24, 3}, offsets))),
              HasSubstr("the offsets do not form a body"));
}

// The sample in InterMimic's form: the clip's joints have the positions of the file.
TEST(InterMimicTest, RealMotionKeepsItsPositions) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  const auto motion =
      value_of(load_smpl((*shared / "data" / "formats" / "omomo_sub3_largebox_003.pt").string()));
  EXPECT_EQ(motion.clip.frame_count(), 196);
  EXPECT_FALSE(motion.approximate_body);
  std::vector<Pose> poses(kSmplJointCount);
  forward_kinematics(motion.clip, 0, poses);
  const Skeleton& skeleton = motion.clip.skeleton();
  const auto place = [&](const char* name) { return poses[*skeleton.find(name)].translation; };
  EXPECT_NEAR((place("left_elbow") - place("left_shoulder")).norm(), 0.288, 1e-3);
  EXPECT_GT(place("head").z(), place("pelvis").z());
}

}  // namespace
}  // namespace retarget
