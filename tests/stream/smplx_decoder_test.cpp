// SMPL's rotation vectors as lines: the frames of a file's motion, body descriptions, rejections.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "live/stream/stream_formats.h"
#include "stream/stream_support.h"
#include "support/load_smpl.h"
#include "support/npz_builder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

// Upright, with random rotations; frames of 66 numbers and 3.
struct Motion {
  static constexpr std::size_t kFrames = 12;
  std::vector<double> poses, trans, betas = {0.7, -0.2};

  Motion() {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> turn(-0.4, 0.4);
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      for (int i = 0; i < 66; ++i) poses.push_back(turn(engine) + (i == 0 ? 1.5 : 0.0));
      trans.insert(trans.end(), {0.01 * static_cast<double>(frame), turn(engine), 0.9});
    }
  }

  [[nodiscard]] std::string npz() const {
    return NpzBuilder()
        .add("poses", npy_doubles({kFrames, 66}, poses))
        .add("trans", npy_doubles({kFrames, 3}, trans))
        .add("betas", npy_doubles({2}, betas))
        .add("fps", npy_doubles({1}, {30.0}))
        .build();
  }

  [[nodiscard]] Json line(std::size_t frame) const {
    const auto part = [frame](const std::vector<double>& all, std::size_t width, std::size_t begin,
                              std::size_t end) {
      const auto row = all.begin() + static_cast<long>(frame * width);
      return std::vector<double>(row + static_cast<long>(begin), row + static_cast<long>(end));
    };
    return {{"time", static_cast<double>(frame) / 30.0},
            {"betas", betas},
            {"gender", "neutral"},
            {"transl", part(trans, 3, 0, 3)},
            {"global_orient", part(poses, 66, 0, 3)},
            {"body_pose", part(poses, 66, 3, 66)}};
  }
};

void expect_same(const StreamFrame& frame, const Clip& clip, int index, double tolerance) {
  ASSERT_EQ(frame.rotations.size(), clip.rotations(index).size());
  for (std::size_t i = 0; i < frame.rotations.size(); ++i) {
    EXPECT_LE(frame.rotations[i].angularDistance(clip.rotations(index)[i]), tolerance);
  }
  EXPECT_LE((frame.translations[0] - clip.translations(index)[0]).norm(), tolerance);
}

TEST(SmplxLines, MatchTheFramesOfTheSameFile) {
  const Motion motion;
  const auto read = value_of(read_smpl(motion.npz(), "motion.npz"));
  const auto decoder = stream_decoder("smplx");
  KeptStream kept;
  for (std::size_t frame = 0; frame < Motion::kFrames; ++frame) {
    ASSERT_TRUE(decoder->take(motion.line(frame).dump(), kept));
  }
  // The body is described once, although every line has its betas.
  ASSERT_EQ(kept.skeletons.size(), 1U);
  const Skeleton& skeleton = kept.skeletons[0].skeleton();
  EXPECT_EQ(skeleton.names(), read.clip.skeleton().names());
  EXPECT_NEAR(*kept.skeletons[0].origin().body_height, 1.73, 1e-12);
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    EXPECT_EQ(skeleton.joint(joint).offset, read.clip.skeleton().joint(joint).offset);
  }
  ASSERT_EQ(kept.frames.size(), Motion::kFrames);
  for (std::size_t frame = 0; frame < Motion::kFrames; ++frame) {
    expect_same(kept.frames[frame], read.clip, static_cast<int>(frame), 0.0);
    EXPECT_EQ(kept.frames[frame].time, static_cast<double>(frame) / 30.0);
  }
}

TEST(SmplxLines, WithoutFrameAndBodyAreMalformed) {
  const auto decoder = stream_decoder("smplx");
  KeptStream kept;
  for (const char* line : {"{}", R"({"foo": 1})", R"({"time": 1.5, "joints": [0, 0, 0]})"}) {
    EXPECT_FALSE(decoder->take(line, kept)) << line;
  }
  EXPECT_TRUE(kept.skeletons.empty());
  EXPECT_TRUE(decoder->take(R"({"gender": "male"})", kept));
}

TEST(SmplxLines, PlayAFileUnchanged) {
  const auto read = value_of(read_smpl(Motion().npz(), "motion.npz"));
  ASSERT_FALSE(format_of("smplx").plays_human(read.clip));
  const auto encoder = stream_encoder("smplx");
  const auto decoder = stream_decoder("smplx");
  KeptStream kept;
  std::string header = encoder->begin(read.clip);
  ASSERT_TRUE(decoder->take(header, kept));
  ASSERT_EQ(kept.skeletons.size(), 1U);
  const Skeleton& skeleton = kept.skeletons[0].skeleton();
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    EXPECT_LT((skeleton.joint(joint).offset - read.clip.skeleton().joint(joint).offset).norm(),
              1e-12);
    const auto& tips = skeleton.joint(joint).end_sites;
    ASSERT_EQ(tips.size(), read.clip.skeleton().joint(joint).end_sites.size());
  }
  for (int frame = 0; frame < read.clip.frame_count(); ++frame) {
    ASSERT_TRUE(decoder->take(encoder->frame(read.clip, frame).value(), kept));
    expect_same(kept.frames.back(), read.clip, frame, 1e-7);
  }
}

TEST(SmplxLines, AcceptNamesOfOtherPrograms) {
  const Motion motion;
  const Json line = motion.line(3);
  const auto frame_of = [](const Json& told) {
    const auto decoder = stream_decoder("smplx");
    KeptStream kept;
    const auto taken = decoder->take(told.dump(), kept);
    EXPECT_TRUE(taken) << describe(taken.error());
    return kept.frames.at(0);
  };
  const StreamFrame expected = frame_of(line);
  Json amass = {{"trans", line["transl"]},
                {"root_orient", line["global_orient"]},
                {"pose_body", line["body_pose"]}};
  Json nested = line;
  nested["global_orient"] = Json::array({line["global_orient"]});
  nested["left_hand_pose"] = std::vector<double>(45, 0.1);
  nested["body_pose"] = Json::array();
  for (std::size_t i = 0; i < 63; i += 3) {
    const Json& all = line["body_pose"];
    nested["body_pose"].push_back(Json::array({all[i], all[i + 1], all[i + 2]}));
  }
  Json poses = {{"transl", line["transl"]}, {"poses", line["global_orient"]}};
  for (const Json& number : line["body_pose"]) poses["poses"].push_back(number);
  for (int i = 66; i < 165; ++i) poses["poses"].push_back(0.2);
  for (const Json& told : {amass, nested, poses}) {
    const StreamFrame frame = frame_of(told);
    for (std::size_t i = 0; i < frame.rotations.size(); ++i) {
      EXPECT_EQ(frame.rotations[i].coeffs(), expected.rotations[i].coeffs());
    }
    EXPECT_EQ(frame.translations[0], expected.translations[0]);
  }
}

TEST(SmplxLines, AWorldMayHaveYUp) {
  Json line = Motion().line(0);
  line["global_orient"] = {0, 0, 0};
  line["transl"] = {1, 2, 3};
  const auto decoder = stream_decoder("smplx");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(R"({"up": "y", "height": 1.6})", kept));
  ASSERT_TRUE(decoder->take(line.dump(), kept));
  EXPECT_EQ(kept.skeletons.at(0).origin().body_height, 1.6);
  const StreamFrame& frame = kept.frames.at(0);
  EXPECT_LT((frame.translations[0] - Eigen::Vector3d(1, -3, 2)).norm(), 1e-12);
  EXPECT_LT((frame.rotations[0] * Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitZ()).norm(),
            1e-12);
  // Another body, in a separate line.
  ASSERT_TRUE(decoder->take(R"({"height": 1.9})", kept));
  EXPECT_EQ(kept.skeletons.size(), 2U);
}

TEST(SmplxLines, UseTheBodyOfTheUsersFile) {
  const Motion motion;
  const auto read = read_smpl(motion.npz(), "motion.npz");
  const auto decoder = stream_decoder("smplx");
  decoder->know_skeleton(read->clip.shared_skeleton());
  KeptStream kept;
  Json line = motion.line(2);
  line["betas"] = {-3.0};
  ASSERT_TRUE(decoder->take(line.dump(), kept));
  EXPECT_TRUE(kept.skeletons.empty());
  expect_same(kept.frames.at(0), read->clip, 2, 0.0);
  // With fingers, as in files with moving hands.
  decoder->know_skeleton(smpl_skeleton(generic_smpl_rest_body(1.7), true));
  ASSERT_TRUE(decoder->take(line.dump(), kept));
  EXPECT_EQ(kept.frames.at(1).rotations.size(), 52U);
}

TEST(SmplxLines, AreRejectedWithAReason) {
  const Json line = Motion().line(0);
  const auto refusal = [&](const std::function<void(Json&)>& change) {
    Json changed = line;
    change(changed);
    const auto decoder = stream_decoder("smplx");
    KeptStream kept;
    const auto taken = decoder->take(changed.dump(), kept);
    EXPECT_FALSE(taken) << changed.dump().substr(0, 200);
    EXPECT_TRUE(kept.frames.empty());
    return taken ? std::string() : taken.error().message;
  };
  EXPECT_THAT(refusal([](Json& l) { l = {1, 2}; }), HasSubstr("object"));
  EXPECT_THAT(refusal([](Json& l) { l.erase("body_pose"); }), HasSubstr("body_pose"));
  EXPECT_THAT(refusal([](Json& l) { l.erase("transl"); }), HasSubstr("transl"));
  EXPECT_THAT(refusal([](Json& l) { l["body_pose"].erase(0); }), HasSubstr("63"));
  EXPECT_THAT(refusal([](Json& l) { l["body_pose"][4] = "x"; }), HasSubstr("body_pose"));
  EXPECT_THAT(refusal([](Json& l) { l["body_pose"][4] = 180.0; }), HasSubstr("100"));
  EXPECT_THAT(refusal([](Json& l) { l["transl"][0] = 1e9; }), HasSubstr("transl"));
  EXPECT_THAT(refusal([](Json& l) { l["left_hand_pose"] = {"x"}; }), HasSubstr("left_hand_pose"));
  EXPECT_THAT(refusal([](Json& l) { l["time"] = "now"; }), HasSubstr("time"));
  EXPECT_THAT(refusal([](Json& l) { l["up"] = "x"; }), HasSubstr("up"));
  EXPECT_THAT(refusal([](Json& l) { l["height"] = 17.5; }), HasSubstr("height"));
  EXPECT_THAT(refusal([](Json& l) { l["betas"] = {40.0}; }), HasSubstr("betas"));
  EXPECT_THAT(refusal([](Json& l) { l["rest_offsets"] = std::vector<double>(66, 0.0); }),
              HasSubstr("T-pose"));
}

}  // namespace
}  // namespace retarget
