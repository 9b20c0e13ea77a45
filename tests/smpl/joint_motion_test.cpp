// Joint positions in NPZ files, single arrays and pickles: shapes, rates, names, several motions.

#include "formats/smpl/joint_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "joint_motion_support.h"
#include "motion_parts.h"

namespace retarget {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string texts_of(const JointMotion& motion) {
  std::string text;
  for (const Warning& warning : motion.warnings) text += warning.message + "\n";
  return text;
}

TEST(JointMotionTest, ReadsShapesOfHumanMlAndMdm) {
  const JointMotion human_ml = joints_of(npy_doubles({2, 22, 3}, counted(132)));
  EXPECT_EQ(human_ml.frame_count, 2);
  EXPECT_EQ(human_ml.joint_count, 22);
  EXPECT_EQ(human_ml.position(1, 2), Eigen::Vector3d(72, 73, 74));
  EXPECT_EQ(to_text(human_ml.rate), "20");
  EXPECT_THAT(texts_of(human_ml), HasSubstr("assuming 20 fps, as HumanML3D and MDM have"));
  EXPECT_TRUE(human_ml.names.empty());
  EXPECT_EQ(human_ml.up, Eigen::Vector3d(Eigen::Vector3d::UnitY()));

  // Samples, joints, axes, frames.
  ArrayReadOptions second;
  second.take = "2";
  const std::string mdm = npy_doubles({3, 22, 3, 4}, counted(792));
  const JointMotion motion = joints_of(mdm, second);
  EXPECT_EQ(motion.frame_count, 4);
  EXPECT_EQ(motion.position(3, 1), Eigen::Vector3d(264 + 15, 264 + 19, 264 + 23));
  EXPECT_THAT(joint_error(mdm), HasSubstr("the file holds 3 motions"));
  EXPECT_THAT(joint_error(mdm), HasSubstr("--take N chooses one, 1 to 3"));
  second.take = "4";
  EXPECT_THAT(joint_error(mdm, second), HasSubstr("no motion \"4\": the file holds 3 motions"));
  const JointMotion alone = joints_of(npy_doubles({22, 3, 4}, counted(264)));
  EXPECT_EQ(alone.frame_count, 4);
  EXPECT_EQ(joints_of(npy_doubles({1, 5, 22, 3}, counted(330))).frame_count, 5);
}

// A dictionary in the form of numpy.save: an array of one pickled object.
std::string saved_dictionary(const std::string& members) {
  using namespace std::string_literals;
  const std::string pickle =
      "\x80\x03"
      "cnumpy.core.multiarray\n_reconstruct\n"
      "cnumpy\nndarray\n"
      "K\0\x85"
      "C\x01"
      "b"
      "\x87R(K\x01)"
      "cnumpy\ndtype\n"
      "X\x02\0\0\0"
      "O8"
      "\x89\x88\x87R(K\x03X\x01\0\0\0|NNNJ"
      "\xFF\xFF\xFF\xFFJ\xFF\xFF\xFF\xFFK?tb\x89]"s;
  return npy("|O", "()", pickle + members + "atb.");
}

std::string dictionary_of_arrays(const std::vector<std::pair<std::string, NpyArray>>& members) {
  PickleWriter writer;
  writer.begin_dict();
  for (const auto& [name, array] : members) {
    writer.text(name);
    writer.array(array);
  }
  writer.end_dict();
  std::string pickle = writer.finish();
  // Without its own head and end.
  return pickle.substr(2, pickle.size() - 3);
}

TEST(JointMotionTest, ReadsMdmResults) {
  const std::vector<double> lengths = {3, 4};
  const std::string members =
      dictionary_of_arrays({{"motion", float64_array(counted(2 * 22 * 3 * 4), {2, 22, 3, 4})},
                            {"lengths", float64_array(lengths, {2})}});
  ArrayReadOptions options;
  options.take = "1";
  const JointMotion motion = joints_of(saved_dictionary(members), options);
  EXPECT_EQ(motion.frame_count, 3);
  EXPECT_EQ(motion.joint_count, 22);
  EXPECT_EQ(to_text(motion.rate), "20");
  options.take = "2";
  EXPECT_EQ(joints_of(saved_dictionary(members), options).frame_count, 4);
  const std::string whole = saved_dictionary(members);
  for (std::size_t size = 0; size < whole.size(); size += 111) {
    EXPECT_FALSE(read_array_motion(whole.substr(0, size), "x", options).has_value());
  }
  using namespace std::string_literals;
  const std::string evil =
      "\x80\x02"
      "cposix\nsystem\nX\x02\0\0\0id\x85R."s;
  EXPECT_THAT(joint_error(npy("|O", "()", evil)), HasSubstr("posix.system, which is not allowed"));
}

TEST(JointMotionTest, ReadsNpzWithNamesRatesAndHeight) {
  NpzWriter writer;
  const std::vector<std::string> names = {"a", "b"};
  writer.add("joint_positions", float64_array(counted(12), {2, 2, 3}));
  writer.add("joint_names", text_array(names));
  writer.add("fps", float64_array(std::vector<double>{25}, {}));
  writer.add("height", float64_array(std::vector<double>{1.8}, {}));
  const std::string bytes = writer.finish().value();
  const JointMotion motion = joints_of(bytes);
  EXPECT_EQ(motion.names, names);
  EXPECT_EQ(to_text(motion.rate), "25");
  EXPECT_EQ(motion.height, 1.8);
  EXPECT_TRUE(motion.warnings.empty());
  ArrayReadOptions other;
  other.source_fps = 50;
  other.joint_names = {"x", "y"};
  EXPECT_EQ(to_text(joints_of(bytes, other).rate), "50");
  EXPECT_EQ(joints_of(bytes, other).names, other.joint_names);
  other.joint_names = {"x"};
  EXPECT_THAT(joint_error(bytes, other),
              HasSubstr("it has 2 joints, but there is 1 name in the file of --joint-names"));
}

TEST(JointMotionTest, ReportsAssumedRates) {
  const auto places = [](const char* name, std::size_t joints) {
    NpzWriter writer;
    writer.add(name, float64_array(counted(6 * joints), {2, joints, 3}));
    return writer.finish().value();
  };
  EXPECT_EQ(to_text(joints_of(places("global_joint_positions", 22)).rate), "30");
  EXPECT_EQ(to_text(joints_of(npy_doubles({2, 53, 3}, counted(318))).rate), "120");
  const auto unknown = joints_of(places("joints", 24)).no_rate;
  ASSERT_TRUE(unknown);
  EXPECT_THAT(unknown->message, HasSubstr("no frame rate"));
  EXPECT_THAT(unknown->hint, HasSubstr("source-fps"));
}

TEST(JointMotionTest, ReadsRatesByTheirUsualNames) {
  const auto file = [](const char* rate, double value, bool with_names) {
    NpzWriter writer;
    writer.add("joints", float64_array(counted(132), {2, 22, 3}));
    if (with_names) writer.add("joint_names", text_array(std::vector<std::string>(22, "a")));
    writer.add(rate, float64_array(std::vector<double>{value}, {}));
    return writer.finish().value();
  };
  for (const char* rate :
       {"fps", "frame_rate", "framerate", "mocap_framerate", "mocap_frame_rate"}) {
    EXPECT_EQ(to_text(joints_of(file(rate, 30, true)).rate), "30") << rate;
  }
  for (const char* time : {"dt", "frame_time", "frametime"}) {
    const JointMotion motion = joints_of(file(time, 0.033333, true));
    EXPECT_EQ(to_text(motion.rate), "30") << time;
    EXPECT_EQ(texts_of(motion), "") << time;
  }
  EXPECT_THAT(joint_error(file("dt", -1.0, true)), HasSubstr("expected seconds per frame"));
  // Without a rate, 22 joints are HumanML3D's only if the file does not name them.
  const auto unknown = joints_of(file("other", 30, true)).no_rate;
  ASSERT_TRUE(unknown);
  EXPECT_THAT(unknown->message, HasSubstr("no frame rate: found none of"));
  EXPECT_EQ(joints_of(file("other", 30, false)).order_of_rate, "SMPL");
  EXPECT_EQ(joints_of(file("dt", 0.05, false)).order_of_rate, "");
  EXPECT_EQ(joints_of(file("dt", 0.05, false)).up, std::nullopt);
}

std::string kimodo(std::size_t joints, double one = 1.0) {
  NpzWriter writer;
  std::vector<double> matrices;
  for (std::size_t i = 0; i < 2 * joints; ++i) {
    for (int k = 0; k < 9; ++k) matrices.push_back(k % 4 == 0 ? one : 0.0);
  }
  writer.add("posed_joints", float64_array(counted(6 * joints), {2, joints, 3}));
  writer.add("global_rot_mats", float64_array(matrices, {2, joints, 3, 3}));
  return writer.finish().value();
}

TEST(JointMotionTest, KimodoHasRotations) {
  const JointMotion motion = joints_of(kimodo(77));
  EXPECT_EQ(motion.rotations.size(), 154U);
  EXPECT_EQ(motion.names.size(), 77U);
  EXPECT_EQ(motion.names[66 + 1], "LeftLeg");
  EXPECT_EQ(to_text(motion.rate), "30");
  EXPECT_EQ(joints_of(kimodo(30)).names.back(), "RightToeBase");
  EXPECT_EQ(joints_of(kimodo(22)).names.front(), "pelvis");
  EXPECT_THAT(joint_error(kimodo(34)), HasSubstr("found a robot motion: Kimodo's G1"));
  EXPECT_THAT(joint_error(kimodo(27)), HasSubstr("77 or 30 SOMA joints"));
  EXPECT_THAT(joint_error(kimodo(22, 1.1)),
              HasSubstr("invalid rotation matrix in frame 0, joint 0"));
  EXPECT_THAT(joint_error(kimodo(22, -1.0)),
              HasSubstr("invalid rotation matrix in frame 0, joint 0"));
}

TEST(JointMotionTest, UsualNamesComeBeforeOthers) {
  NpzWriter writer;
  writer.add("keypoints", float64_array(counted(396), {6, 22, 3}));
  writer.add("motion", float64_array(counted(132), {2, 22, 3}));
  EXPECT_EQ(joints_of(writer.finish().value()).frame_count, 2);
}

TEST(JointMotionTest, KnowsTheNamesOfOtherPrograms) {
  for (const char* name :
       {"keypoints", "keypoints3d", "keypoints_3d", "joints3d", "joints_3d", "poses3d",
        "pred_keypoints_3d", "positions_3d", "xyz", "pose_world_landmarks", "Joints3D"}) {
    NpzWriter writer;
    writer.add(name, float64_array(counted(132), {2, 22, 3}));
    EXPECT_EQ(joints_of(writer.finish().value()).frame_count, 2) << name;
  }
}

TEST(JointMotionTest, RejectsOtherArrays) {
  std::vector<double> values = counted(132);
  values[70] = std::nan("");
  EXPECT_THAT(joint_error(npy_doubles({2, 22, 3}, values)),
              AllOf(HasSubstr("NaN in frame 1, joint 1"), HasSubstr("at most 30 frames")));
  EXPECT_THAT(joint_error(npy_doubles({0, 22, 3}, {})), HasSubstr("no frames"));
  EXPECT_THAT(joint_error(npy_doubles({2, 22, 4}, counted(176))),
              AllOf(HasSubstr("(2, 22, 4)"), HasSubstr("removes the confidence")));
  EXPECT_THAT(joint_error(npy_doubles({2, 22, 2}, counted(88))), HasSubstr("no depth"));
  EXPECT_THAT(joint_error(npy_doubles({20, 2, 17, 3}, counted(2040))),
              HasSubstr("20 frames of 2 people"));
  EXPECT_THAT(joint_error(npy_doubles({2, 66}, counted(132))), HasSubstr("(frames, joints, 3)"));
  EXPECT_THAT(joint_error(npy("<f8", "(1152921504606846976, 22, 3)", "")), HasSubstr("shape"));
  ArrayReadOptions little;
  little.max_clip_bytes = 3000;
  EXPECT_THAT(joint_error(npy_doubles({2, 22, 3}, counted(132)), little), HasSubstr("memory"));
  ArrayReadOptions take;
  take.take = "2";
  EXPECT_THAT(joint_error(Parts().npz(), take), HasSubstr("only one motion"));
}

TEST(JointMotionTest, SelectsOneOfSeveralDictionaries) {
  // WHAM: a dictionary by person number.
  PickleWriter writer;
  writer.begin_dict();
  for (const char* who : {"ann", "bob"}) {
    writer.text(who);
    writer.begin_dict();
    writer.text("pose_world");
    writer.array(float64_array(std::vector<double>(144, who[0] == 'a' ? 0.1 : 0.2), {2, 72}));
    writer.text("trans_world");
    writer.array(float64_array(std::vector<double>(6), {2, 3}));
    writer.end_dict();
  }
  writer.end_dict();
  const std::string bytes = writer.finish();
  ArrayReadOptions options;
  options.source_fps = 30;
  EXPECT_THAT(joint_error(bytes, options), HasSubstr("the file holds 2 motions: ann, bob"));
  EXPECT_THAT(joint_error(bytes, options), HasSubstr("--take NAME chooses one"));
  options.take = "bob";
  const SmplMotion bob = motion_of(bytes, options);
  options.take = "2";
  expect_same_motion(motion_of(bytes, options), bob);
  options.take = "carl";
  EXPECT_THAT(joint_error(bytes, options), HasSubstr("no motion \"carl\""));
}

}  // namespace
}  // namespace retarget
