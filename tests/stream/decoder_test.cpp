// Decoders: frames, skeletons and rejections from bytes, and round trips of the player's packets.

#include "live/stream/stream_formats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "stream/stream_support.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using testing::HasSubstr;

// Takes one line at a time, like a source.
Result<void> take_lines(Decoder& decoder, std::string_view text, StreamSink& sink) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (end > 0) {
      if (auto taken = decoder.take(text.substr(0, end), sink); !taken) return taken;
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return {};
}

std::string refused_line(Decoder& decoder, std::string_view line) {
  KeptStream kept;
  const auto taken = decoder.take(line, kept);
  EXPECT_FALSE(taken) << line;
  EXPECT_TRUE(kept.frames.empty());
  return taken ? "" : taken.error().message;
}

TEST(StreamFormats, PlayedFramesRoundTrip) {
  const Clip clip = sample_clip("walk");
  for (const StreamFormat& format : stream_formats()) {
    // Other formats have their own tests.
    if (!format.is_text || format.plays_human != nullptr) continue;
    const auto encoder = format.encoder();
    const auto decoder = format.decoder(parse_address("udp:1?fps=60").value());
    KeptStream kept;
    ASSERT_TRUE(take_lines(*decoder, encoder->begin(clip), kept)) << format.name;
    ASSERT_EQ(kept.skeletons.size(), 1U) << format.name;
    const Skeleton& skeleton = kept.skeletons[0].skeleton();
    EXPECT_EQ(skeleton.names(), clip.skeleton().names()) << format.name;
    for (int frame = 0; frame < 10; ++frame) {
      const auto bytes = value_of(encoder->frame(clip, frame));
      ASSERT_TRUE(take_lines(*decoder, bytes, kept)) << format.name;
    }
    ASSERT_EQ(kept.frames.size(), 10U) << format.name;
    Clip back(kept.skeletons[0].shared_skeleton(), clip.rate(), 10);
    std::vector<Pose> expected(static_cast<std::size_t>(skeleton.joint_count())), found = expected;
    for (int frame = 0; frame < 10; ++frame) {
      const StreamFrame& streamed = kept.frames[static_cast<std::size_t>(frame)];
      std::ranges::copy(streamed.rotations, back.rotations(frame).begin());
      std::ranges::copy(streamed.translations, back.translations(frame).begin());
      forward_kinematics(clip, frame, expected);
      forward_kinematics(back, frame, found);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_LT((expected[i].translation - found[i].translation).norm(), 1e-6) << format.name;
        EXPECT_LT(expected[i].rotation.angularDistance(found[i].rotation), 1e-6) << format.name;
      }
    }
  }
}

TEST(StreamFormats, AreFoundByName) {
  EXPECT_EQ((*find_stream_format(""))->name, "lines");
  EXPECT_EQ((*find_stream_format("bvh"))->name, "bvh");
  const auto unknown = find_stream_format("bhv");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(describe(unknown.error()), HasSubstr("bvh"));
}

TEST(Lines, ReportTheirProperties) {
  const auto decoder = stream_decoder("lines");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(
      R"({"skeleton": {"up": "y", "unit": 0.01, "height": 1.8, "joints": [
          {"name": "Hips", "parent": null, "rest": [0, 100, 0, 1, 0, 0, 0]},
          {"name": "Spine", "parent": "Hips", "rest": [0, 120, 0, 0, 1, 0, 0]}]}})",
      kept));
  ASSERT_EQ(kept.skeletons.size(), 1U);
  EXPECT_TRUE(kept.rests[0]);
  const Clip& clip = kept.skeletons[0];
  EXPECT_EQ(clip.origin().metres_per_unit, 0.01);
  EXPECT_EQ(clip.origin().body_height, 1.8);
  EXPECT_EQ(clip.origin().up, Eigen::Vector3d(Eigen::Vector3d::UnitY()));
  EXPECT_EQ(clip.skeleton().joint(1).offset, Eigen::Vector3d(0, 20, 0));
  ASSERT_TRUE(decoder->take(
      R"({"time": 2.5, "joints": {"Spine": [1, 120, 0, 2, 0, 0, 0], "Hips": [1, 100, 0, 1, 0, 0, 0],
          "Hat": [0, 0, 0, 1, 0, 0, 0]}})",
      kept));
  ASSERT_EQ(kept.frames.size(), 1U);
  EXPECT_EQ(kept.frames[0].time, 2.5);
  EXPECT_EQ(kept.frames[0].translations[1], Eigen::Vector3d(0, 20, 0));
  EXPECT_EQ(kept.frames[0].rotations[1].w(), 1.0);
}

TEST(Lines, AreRejectedWithAReason) {
  const auto decoder = stream_decoder("lines");
  EXPECT_THAT(refused_line(*decoder, R"({"joints": {}})"), HasSubstr("before the skeleton"));
  EXPECT_THAT(refused_line(*decoder, "nonsense"), testing::Not(testing::IsEmpty()));
  EXPECT_THAT(refused_line(*decoder, "[1, 2]"), HasSubstr("object"));
  EXPECT_THAT(refused_line(*decoder, R"({"skeleton": 3})"), HasSubstr("joints"));
  EXPECT_THAT(refused_line(*decoder, R"({"skeleton": {"joints": [{"name": "a"}, {"name": "a"}]}})"),
              HasSubstr("duplicated"));
  EXPECT_THAT(
      refused_line(*decoder,
                   R"({"skeleton": {"joints": [{"name": "a"}, {"name": "b", "parent": "c"}]}})"),
      HasSubstr("before it"));
  EXPECT_THAT(refused_line(*decoder, R"({"skeleton": {"up": "w", "joints": [{"name": "a"}]}})"),
              HasSubstr("up"));
  KeptStream kept;
  ASSERT_TRUE(decoder->take(R"({"skeleton": {"joints": [{"name": "a"}]}})", kept));
  EXPECT_FALSE(kept.rests[0]);
  EXPECT_THAT(refused_line(*decoder, R"({"joints": {}})"), HasSubstr("missing"));
  EXPECT_THAT(refused_line(*decoder, R"({"joints": {"a": [1, 2, 3]}})"), HasSubstr("seven"));
  EXPECT_THAT(refused_line(*decoder, R"({"joints": {"a": [1, 2, 3, 0, 0, 0, 0]}})"),
              HasSubstr("the rotation is zero"));
  EXPECT_THAT(refused_line(*decoder, R"({"joints": {"a": [1e99, 2, 3, 1, 0, 0, 0]}})"),
              HasSubstr("seven"));
  EXPECT_THAT(refused_line(*decoder, R"({"time": "now", "joints": {"a": [1, 2, 3, 1, 0, 0, 0]}})"),
              HasSubstr("time"));
}

TEST(BvhRows, RequireASkeleton) {
  const auto decoder = stream_decoder("bvh");
  EXPECT_THAT(refused_line(*decoder, "1 2 3"), HasSubstr("skeleton"));
  decoder->know_skeleton(sample_clip("walk").shared_skeleton());
  EXPECT_THAT(refused_line(*decoder, "1 2 3"), HasSubstr("numbers"));
  std::string row;
  for (int i = 0; i < sample_clip("walk").skeleton().channel_count(); ++i)
    row += i == 0 ? "0" : " 0";
  KeptStream kept;
  ASSERT_TRUE(decoder->take(row + "\r\n", kept));
  EXPECT_TRUE(std::isnan(kept.frames.at(0).time));
  EXPECT_THAT(refused_line(*decoder, row + " 0"), HasSubstr("numbers"));
  EXPECT_THAT(refused_line(*decoder, row.substr(1) + " nan"), HasSubstr("numbers"));
}

TEST(BvhRows, NameAMissingPartOfTheStream) {
  const auto decoder = stream_decoder("bvh");
  const std::string header = stream_encoder("bvh")->begin(sample_clip("walk"));
  KeptStream kept;
  EXPECT_EQ(decoder->lack(), "");
  ASSERT_TRUE(take_lines(*decoder, header.substr(0, 300), kept));
  EXPECT_THAT(decoder->lack(), HasSubstr("incomplete"));
  ASSERT_TRUE(take_lines(*decoder, header, kept));
  EXPECT_THAT(decoder->lack(), HasSubstr("no rows"));
}

TEST(BvhRows, DeclareTheirFrameTime) {
  const Clip clip = sample_clip("walk");
  const auto encoder = stream_encoder("bvh");
  const auto decoder = stream_decoder("bvh");
  KeptStream kept;
  ASSERT_TRUE(take_lines(*decoder, encoder->begin(clip), kept));
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(decoder->take(encoder->frame(clip, i).value(), kept));
  EXPECT_TRUE(std::isnan(kept.frames[2].time));
  EXPECT_EQ(kept.frames[2].declared, clip.rate().time_of(2));
  for (const char* wrong : {"Frame Time: 0", "Frame Time: -1", "Frame Time: nan", "Frame Time:"}) {
    const auto other = stream_decoder("bvh");
    ASSERT_TRUE(take_lines(*other, encoder->begin(clip), kept));
    ASSERT_TRUE(other->take(wrong, kept)) << wrong;
    ASSERT_TRUE(other->take(encoder->frame(clip, 0).value(), kept)) << wrong;
    EXPECT_EQ(kept.frames.back().declared, 0.0) << "the valid one before it applies";
  }
}

TEST(StreamFormats, ThatNeedPacketsUseNoPipes) {
  const StreamFormat& vmc = **find_stream_format("vmc");
  for (const char* place : {"stdin?format=vmc", "udp:1?format=vmc", "tcp:1?format=vmc"}) {
    const bool is_pipe = std::string_view(place).starts_with("stdin");
    const auto checked = check_input(parse_address(place).value(), vmc);
    EXPECT_EQ(checked.has_value(), !is_pipe) << place;
    if (!checked) {
      EXPECT_THAT(checked.error().hint, HasSubstr("udp:39539"));
    }
  }
  for (const char* place : {"stdout", "walk.vmc"}) {
    const auto checked = check_player_target(parse_address(place).value(), vmc);
    ASSERT_FALSE(checked) << place;
    EXPECT_EQ(checked.error().kind, ErrorKind::kUsage);
  }
  EXPECT_TRUE(check_player_target(parse_address("stdout").value(), **find_stream_format("mvn")));
}

TEST(BvhRows, KeepTheSkeletonOfTheUsersFile) {
  const Clip clip = sample_clip("walk");
  const auto decoder = stream_decoder("bvh");
  decoder->know_skeleton(clip.shared_skeleton());
  KeptStream kept;
  ASSERT_TRUE(take_lines(*decoder, stream_encoder("bvh")->begin(clip), kept));
  EXPECT_TRUE(kept.skeletons.empty());
}

TEST(Addresses, ParseFromText) {
  const auto udp = value_of(parse_address("udp:1118?format=bvh&fps=60"));
  EXPECT_EQ(udp.transport, Transport::kUdp);
  EXPECT_EQ(udp.host, "127.0.0.1");
  EXPECT_EQ(udp.port, 1118);
  EXPECT_EQ(udp.format, "bvh");
  EXPECT_EQ(udp.extra("fps"), "60");
  EXPECT_EQ(udp.extra("rate"), "");
  EXPECT_EQ(parse_address("tcp:0.0.0.0:9763")->host, "0.0.0.0");
  EXPECT_EQ(parse_address("tcp:localhost:1")->host, "127.0.0.1");
  EXPECT_EQ(parse_address("-")->transport, Transport::kStdout);
  EXPECT_EQ(parse_address("stdin?format=lines")->transport, Transport::kStdin);
  EXPECT_EQ(parse_address("out/walk.csv")->file, "out/walk.csv");
  for (const char* bad : {"udp:", "udp:x", "udp:70000", "udp:1.2.3:4", "udp:1.2.3.400:4", "udp:1?x",
                          "tcp:1?=2", "", "?format=bvh"}) {
    const auto refused = parse_address(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace retarget
