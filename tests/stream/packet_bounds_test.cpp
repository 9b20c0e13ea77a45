// The cost of packets is bounded: hostile packets are rejected early and do not affect the next
// one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "live/stream/message_cutter.h"
#include "live/stream/stream_formats.h"
#include "stream/stream_support.h"
#include "support/processor_time.h"

namespace retarget {
namespace {

using testing::HasSubstr;

constexpr std::size_t kDatagram = 65000;  // bytes

// A packet costs at most as much as this many ordinary objects of a datagram's size, so that
// sanitizers and slow machines do not matter. One object takes about a millisecond.
constexpr double kMostObjects = 3.0;
constexpr int kRuns = 5;

class Counted final : public StreamSink {
 public:
  void take_skeleton(Clip, bool) override { ++skeletons; }
  void take_frame(const StreamFrame&) override { ++frames; }
  int skeletons = 0, frames = 0;
};

std::string object_of_members() {
  std::string text = "{\"a\":1";
  for (int i = 0; text.size() < kDatagram; ++i) text += ",\"" + std::to_string(i) + "\":0";
  return text + "}";
}

// Seconds of the JSON library for an ordinary object of a datagram's size.
double object_time() {
  const std::string text = object_of_members();
  return least_processor_time(kRuns,
                              [&] { static_cast<void>(nlohmann::json::parse(text).size()); });
}

std::string repeated(const std::string& piece, std::size_t bytes) {
  std::string all;
  while (all.size() + piece.size() <= bytes) all += piece;
  return all;
}

void expect_cheap(Decoder& decoder, const std::string& packet, const char* what) {
  Counted counted;
  const double spent =
      least_processor_time(kRuns, [&] { static_cast<void>(decoder.take(packet, counted)); });
  const double most = kMostObjects * object_time();
  EXPECT_LT(spent, most) << what;
  EXPECT_LE(counted.frames, kRuns * 8) << what;
}

// An LZ4 frame (lz4_Frame_format.md) of blocks: a text whose end is repeated, about a megabyte in
// all.
std::string bomb(const std::string& begin, std::uint16_t period) {
  std::string block(1, static_cast<char>(0xFF));
  block += static_cast<char>(begin.size() - 15);
  block += begin;
  block += static_cast<char>(period & 0xFF);
  block += static_cast<char>(period >> 8);
  block += std::string(4000, '\xFF') + std::string(1, '\x00') + std::string("\x50") + "     ";
  std::string frame = "\x04\x22\x4D\x18\x60\x70\x73";
  for (int shift = 0; shift < 32; shift += 8) {
    frame += static_cast<char>(block.size() >> shift & 0xFF);
  }
  return frame + block + std::string(4, '\0');
}

TEST(PacketBounds, RejectLz4BombsEarly) {
  if (!Lz4Frame::is_available()) GTEST_SKIP() << "this build lacks LZ4";
  const auto decoder = stream_decoder("rokoko");
  const std::string one = bomb(R"({"scene": {"a": [0,)", 2);
  Counted counted;
  const auto refused = decoder->take(one, counted);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("exceeds the packet size limit"));
  expect_cheap(*decoder, repeated(one, kDatagram), "frames of a megabyte");
  expect_cheap(*decoder, repeated(bomb(R"({"scene": {"a": "xxxx)", 1), kDatagram), "long texts");
}

TEST(PacketBounds, RejectEndlessObjectsEarly) {
  const auto decoder = stream_decoder("rokoko");
  expect_cheap(*decoder, repeated("{}", kDatagram), "empty objects");
  expect_cheap(*decoder, repeated("{}x", kDatagram), "with noise between them");
  expect_cheap(*decoder, R"({"scene":{"actors":[)" + repeated("{},", kDatagram) + "{}]}}",
               "actors");
  std::string members = R"({"scene":{"a":1)";
  for (int i = 0; members.size() < kDatagram; ++i) members += ",\"" + std::to_string(i) + "\":0";
  expect_cheap(*decoder, members + "}}", "members");
}

TEST(PacketBounds, JsonIsBounded) {
  const auto refusal = [](const std::string& text) {
    const auto parsed = parse_packet_json(text, "the line");
    return parsed ? std::string() : parsed.error().message;
  };
  EXPECT_EQ(refusal(R"({"a": [1, 2, {"b": "[[[[,,,,\"::::"}]})"), "");
  EXPECT_THAT(refusal(std::string(100, '[') + std::string(100, ']')), HasSubstr("nested"));
  EXPECT_THAT(refusal("[" + repeated("0,", 50000) + "0]"), HasSubstr("values"));
  EXPECT_THAT(refusal("\"" + std::string(1 << 20, 'x') + "\""), HasSubstr("megabyte"));
  EXPECT_THAT(refusal("{\"a\": \n nonsense}"), HasSubstr("not JSON: byte"));
  EXPECT_THAT(refusal("[1e999]"), HasSubstr("too large"));
  EXPECT_EQ(parse_packet_json(R"({"a": 1, "a": 2})", "the line").value()["a"], 2);
  const double spent = least_processor_time(kRuns, [&] {
    refusal(repeated("[[[[[[", 1 << 19));
    refusal(repeated("0,", 1 << 19));
  });
  EXPECT_LT(spent, kMostObjects * object_time());
}

TEST(PacketBounds, RejectTooManyLinesEarly) {
  const auto decoder = stream_decoder("lines");
  std::string joints;
  for (int i = 0; joints.size() < kDatagram; ++i) {
    joints += (i == 0 ? "\"" : ",\"") + std::to_string(i) + "\":[0,0,0,1,0,0,0]";
  }
  Counted counted;
  ASSERT_TRUE(decoder->take(R"({"skeleton": {"joints": [{"name": "a"}]}})", counted));
  expect_cheap(*decoder, "{\"joints\":{" + joints + "}}", "joints beyond the skeleton's");
  expect_cheap(*stream_decoder("smplx"), "{\"betas\":[" + repeated("0,", kDatagram) + "0]}",
               "betas");
}

std::string repeated_bundle(const std::string& message) {
  std::string item = std::string(3, '\0') + static_cast<char>(message.size()) + message;
  return std::string("#bundle\0\0\0\0\0\0\0\0\1", 16) + repeated(item, kDatagram);
}

TEST(PacketBounds, RejectOscBundlesEarly) {
  const auto decoder = stream_decoder("vmc");
  const std::string hips = osc_text("/VMC/Ext/Bone/Pos") + osc_text(",sfffffff") +
                           osc_text("Hips") + std::string(24, '\0') + "\x3F\x80" +
                           std::string(2, '\0');
  Counted counted;
  const auto refused = decoder->take(repeated_bundle(hips), counted);
  ASSERT_FALSE(refused);
  EXPECT_LE(counted.frames, 8);
  expect_cheap(*decoder, repeated_bundle(hips), "the same bone again and again");
  expect_cheap(*decoder, repeated_bundle(osc_text("/a")), "short messages");
}

TEST(PacketBounds, RejectHierarchiesEarly) {
  const auto decoder = stream_decoder("bvh");
  std::string text =
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n";
  std::string ends = "}\n";
  for (int i = 0; text.size() + ends.size() < kDatagram; ++i) {
    text += "JOINT j" + std::to_string(i) +
            "\n{\nOFFSET 0 1 0\nCHANNELS 3 Xrotation Yrotation Zrotation\nEnd Site\n{\nOFFSET 0 1 "
            "0\n}\n}\n";
  }
  Counted counted;
  const auto refused = decoder->take(text + ends + "MOTION\n", counted);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("joints"));
  EXPECT_EQ(counted.skeletons, 0);
  expect_cheap(*decoder, text + ends + "MOTION\n", "joints");
}

// A rejected packet does not change how the decoder reads the next one.
TEST(PacketBounds, KeepTheNextPacket) {
  const auto decoder = stream_decoder("lines");
  Counted counted;
  ASSERT_TRUE(decoder->take(R"({"skeleton": {"joints": [{"name": "a"}]}})", counted));
  EXPECT_FALSE(decoder->take(std::string(1000, '['), counted));
  EXPECT_FALSE(
      decoder->take(R"({"skeleton": {"joints": [{"name": "b"}, {"name": "b"}]}})", counted));
  EXPECT_TRUE(decoder->take(R"({"joints": {"a": [0, 0, 0, 1, 0, 0, 0]}})", counted));
  EXPECT_EQ(counted.frames, 1);
}

}  // namespace
}  // namespace retarget
