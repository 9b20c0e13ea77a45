// Streams and the user's file of the same skeleton in other axes and units.

#include "live/stream/file_axes.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/stream_formats.h"
#include "stream/stream_support.h"

namespace retarget {
namespace {

using AxesJson = nlohmann::json;

// A Z-up world from a Y-up one, as capture systems convert it.
const Eigen::Quaterniond kZUpFromYUp(0.5, 0.5, 0.5, 0.5);

// How a sender converts a file with Y up and centimetres to Z up and metres.
struct Conversion {
  bool turns_joints;  // Joint axes turn with the world, so that a zero pose stays one.

  [[nodiscard]] Pose operator()(const Pose& pose) const {
    const Eigen::Quaterniond joints =
        turns_joints ? kZUpFromYUp : Eigen::Quaterniond(Eigen::Quaterniond::Identity());
    return {kZUpFromYUp * pose.rotation * joints.conjugate(),
            0.01 * (kZUpFromYUp * pose.translation)};
  }
};

AxesJson numbers_of_pose(const Pose& pose) {
  const auto& p = pose.translation;
  const auto& q = pose.rotation;
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

// The lines of a sender: its skeleton, and a frame.
std::vector<std::string> converted_lines(const Clip& clip, int frame, const Conversion& convert) {
  const Skeleton& skeleton = clip.skeleton();
  std::vector<Pose> rest(static_cast<std::size_t>(skeleton.joint_count())), world = rest;
  forward_kinematics(Clip(clip.shared_skeleton(), FrameRate{}, 1), 0, rest);
  forward_kinematics(clip, frame, world);
  AxesJson header = {{"pose", "any"}, {"unit", 1}, {"up", "z"}, {"joints", AxesJson::array()}};
  AxesJson poses;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Joint& joint = skeleton.joint(i);
    const AxesJson parent =
        joint.parent < 0 ? AxesJson() : AxesJson(skeleton.joint(joint.parent).name);
    header["joints"].push_back(
        {{"name", joint.name}, {"parent", parent}, {"rest", numbers_of_pose(convert(rest[i]))}});
    poses[joint.name] = numbers_of_pose(convert(world[i]));
  }
  return {AxesJson{{"skeleton", header}}.dump(), AxesJson{{"joints", poses}}.dump()};
}

TEST(FileAxesOfLines, AreThoseOfTheUsersFile) {
  const Clip clip = sample_clip("walk");
  constexpr int kFrame = 100;
  std::vector<Pose> expected(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, kFrame, expected);
  for (const bool turns_joints : {false, true}) {
    const auto decoder = stream_decoder("lines");
    decoder->know_skeleton(clip.shared_skeleton());
    decoder->know_up(Eigen::Vector3d::UnitY());
    KeptStream kept;
    for (const std::string& line : converted_lines(clip, kFrame, {turns_joints})) {
      ASSERT_TRUE(decoder->take(line, kept));
    }
    EXPECT_TRUE(kept.skeletons.empty());
    ASSERT_EQ(kept.frames.size(), 1U);
    const auto found = kept.world(0, clip.shared_skeleton());
    // The heading of the world is free: compare heights, and poses relative to the root.
    const Pose file_from_found = expected[0] * found[0].inverse();
    EXPECT_LT(
        (file_from_found.rotation * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitY()).norm(),
        1e-6);
    EXPECT_NEAR(file_from_found.translation.y(), 0.0, 1e-6);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_LT(distance(file_from_found * found[i], expected[i]), 1e-5) << turns_joints << i;
    }
  }
}

TEST(FileAxesOfLines, ChangeNothingThatIsTheSameOrUnknown) {
  const Clip clip = sample_clip("wave");
  const auto encoder = stream_encoder("lines");
  const auto decoder = stream_decoder("lines");
  decoder->know_skeleton(clip.shared_skeleton());
  decoder->know_up(Eigen::Vector3d::UnitY());
  KeptStream kept;
  // The player states neither unit nor up axis of a BVH file.
  ASSERT_TRUE(decoder->take(encoder->begin(clip), kept));
  ASSERT_TRUE(decoder->take(encoder->frame(clip, 20).value(), kept));
  std::vector<Pose> expected(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, 20, expected);
  const auto found = kept.world(0, clip.shared_skeleton());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT(distance(found[i], expected[i]), 1e-6);
  }
}

// A rejected skeleton is followed by the user's one again.
TEST(FileAxesOfLines, StayThoseOfTheFileAfterAnotherSkeleton) {
  const Clip clip = sample_clip("walk");
  const auto lines = converted_lines(clip, 0, {false});
  const auto decoder = stream_decoder("lines");
  decoder->know_skeleton(clip.shared_skeleton());
  decoder->know_up(Eigen::Vector3d::UnitY());
  KeptStream kept;
  ASSERT_TRUE(decoder->take(lines[0], kept));
  ASSERT_TRUE(decoder->take(lines[1], kept));
  ASSERT_TRUE(decoder->take(R"({"skeleton": {"joints": [{"name": "a"}]}})", kept));
  ASSERT_TRUE(decoder->take(R"({"joints": {"a": [1, 2, 3, 1, 0, 0, 0]}})", kept));
  EXPECT_EQ(kept.frames[1].translations[0], Eigen::Vector3d(1, 2, 3));
  decoder->know_skeleton(clip.shared_skeleton());
  ASSERT_TRUE(decoder->take(lines[1], kept));
  EXPECT_EQ(kept.frames[2].translations[0], kept.frames[0].translations[0]);
}

TEST(FileAxes, KeepAnOddUnitOfBoth) {
  const std::vector<Eigen::Vector3d> offsets = {{0, 17, 0}, {3, 0, 1}};
  const FileAxes axes({offsets, std::nullopt}, 0.0564, {offsets, std::nullopt});
  EXPECT_EQ(axes.child({{}, {1, 2, 3}}).translation, Eigen::Vector3d(1, 2, 3));
}

// Segments of MVN have the axes of a Z-up world in the T-pose; those of a Y-up file of the same body
// have the axes of its world.
TEST(FileAxesOfMvn, AreThoseOfTheUsersFile) {
  const Clip clip = sample_clip("walk");
  const std::string folder = find_data_folder(DataFolder{RETARGET_SOURCE_DIR}).value();
  const Clip human = clip_of_human_bones(clip, {}, folder).value();
  const auto encoder = stream_encoder("mvn");
  const std::string header = encoder->begin(human), frame = encoder->frame(human, 100).value();
  const auto take = [&](Decoder& decoder, KeptStream& kept) {
    ASSERT_TRUE(decoder.take(header, kept));
    ASSERT_TRUE(decoder.take(frame, kept));
  };
  KeptStream without;
  take(*stream_decoder("mvn", parse_address("udp:1").value()), without);
  const auto expected = without.world(0);

  const Eigen::Quaterniond y_up = kZUpFromYUp.conjugate();
  std::vector<Joint> joints = without.skeletons[0].skeleton().joints();
  for (Joint& joint : joints) joint.offset = 100.0 * (y_up * joint.offset);
  const auto file = std::make_shared<const Skeleton>(joints);
  const auto decoder = stream_decoder("mvn", parse_address("udp:1").value());
  decoder->know_skeleton(file);
  decoder->know_up(Eigen::Vector3d::UnitY());
  KeptStream kept;
  take(*decoder, kept);
  EXPECT_TRUE(kept.skeletons.empty());
  ASSERT_EQ(kept.frames.size(), 1U);
  const auto found = kept.world(0, file);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Pose in_file = {y_up * expected[i].rotation * y_up.conjugate(),
                          100.0 * (y_up * expected[i].translation)};
    EXPECT_LT((found[i].translation - in_file.translation).norm(), 1e-3) << i;
    EXPECT_LT(found[i].rotation.angularDistance(in_file.rotation), 1e-5) << i;
  }
}

}  // namespace
}  // namespace retarget
