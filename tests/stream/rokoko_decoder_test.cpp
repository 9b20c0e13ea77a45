// Rokoko Studio: packets of its custom streaming, built by hand; sides, axes, actors, compression,
// connections.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "live/stream/live_pipeline.h"
#include "live/stream/message_cutter.h"
#include "live/stream/stream_formats.h"
#include "retarget/load.h"
#include "retarget/pose.h"
#include "stream/stream_support.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

// In Unity's axes: left-handed, y up; x y z w.
struct UnityPose {
  std::array<double, 3> at;
  std::array<double, 4> turn;
};
using Body = std::map<std::string, UnityPose>;

// A body in a T-pose that faces z, its left towards -x. Rotations are those of Studio's T-pose in
// Rokoko's plugin for Blender (there w comes first).
Body actor_pose() {
  constexpr double s = 0.70711;
  const std::array<double, 4> trunk = {0, 0, -1, 0};
  const std::array<double, 4> left_arm = {-0.5, -0.5, 0.5, -0.5}, right_arm = {0.5, -0.5, 0.5, 0.5};
  const std::array<double, 4> left_leg = {0, s, 0, s}, right_leg = {0, -s, 0, s};
  const std::array<double, 4> left_foot = {0, s, -s, 0}, right_foot = {0, -s, s, 0};
  return {{"hip", {{0, 0.95, 0}, {0, 0, 0, -1}}},
          {"spine", {{0, 1.05, 0}, trunk}},
          {"chest", {{0, 1.25, 0}, trunk}},
          {"neck", {{0, 1.48, 0}, trunk}},
          {"head", {{0, 1.58, 0}, trunk}},
          {"leftShoulder", {{-0.03, 1.42, 0}, {0, 0, s, -s}}},
          {"leftUpperArm", {{-0.17, 1.42, 0}, left_arm}},
          {"leftLowerArm", {{-0.45, 1.42, 0}, left_arm}},
          {"leftHand", {{-0.70, 1.42, 0}, left_arm}},
          {"rightShoulder", {{0.03, 1.42, 0}, {0, 0, s, s}}},
          {"rightUpperArm", {{0.17, 1.42, 0}, right_arm}},
          {"rightLowerArm", {{0.45, 1.42, 0}, right_arm}},
          {"rightHand", {{0.70, 1.42, 0}, right_arm}},
          {"leftUpLeg", {{-0.09, 0.90, 0}, left_leg}},
          {"leftLeg", {{-0.09, 0.48, 0}, left_leg}},
          {"leftFoot", {{-0.09, 0.08, 0}, left_foot}},
          {"leftToe", {{-0.09, 0.02, 0.13}, left_foot}},
          {"leftToeEnd", {{-0.09, 0.02, 0.19}, left_foot}},
          {"rightUpLeg", {{0.09, 0.90, 0}, right_leg}},
          {"rightLeg", {{0.09, 0.48, 0}, right_leg}},
          {"rightFoot", {{0.09, 0.08, 0}, right_foot}},
          {"rightToe", {{0.09, 0.02, 0.13}, right_foot}},
          {"rightToeEnd", {{0.09, 0.02, 0.19}, right_foot}}};
}

// The left arm hangs down: a quarter turn about z, which in a left-handed world takes -x to -y.
Body left_arm_down() {
  Body body = actor_pose();
  // (0, 0, s, s) before the T-pose, in Unity's order of quaternion products.
  for (const char* bone : {"leftUpperArm", "leftLowerArm", "leftHand"}) {
    body[bone].turn = {0.0, -0.70711, 0.0, -0.70711};
  }
  body["leftLowerArm"].at = {-0.17, 1.14, 0};
  body["leftHand"].at = {-0.17, 0.89, 0};
  return body;
}

Json actor_of(const std::string& name, const Body& body) {
  Json bones = Json::object();
  for (const auto& [bone, pose] : body) {
    const auto& [at, turn] = pose;
    bones[bone] = {{"position", {{"x", at[0]}, {"y", at[1]}, {"z", at[2]}}},
                   {"rotation", {{"x", turn[0]}, {"y", turn[1]}, {"z", turn[2]}, {"w", turn[3]}}}};
  }
  return {{"name", name},
          {"color", {0, 0, 255}},
          {"meta", {{"hasGloves", false}, {"hasBody", true}, {"hasFace", false}}},
          {"dimensions", {{"totalHeight", 1.8}, {"hipHeight", 0.95}}},
          {"body", bones}};
}

Json packet_of(const std::vector<Json>& actors, double time) {
  return {{"version", "3,0"},
          {"fps", 60},
          {"scene", {{"timestamp", time}, {"actors", actors}, {"props", Json::array()}}}};
}

std::unique_ptr<Decoder> decoder_at(const std::string& address) {
  return stream_decoder("rokoko", parse_address(address).value());
}

std::string refusal(const std::string& bytes, const std::string& address = "udp:1") {
  const auto decoder = decoder_at(address);
  KeptStream kept;
  const auto taken = decoder->take(bytes, kept);
  EXPECT_FALSE(taken) << bytes.substr(0, 80);
  EXPECT_TRUE(kept.frames.empty());
  return taken ? "" : taken.error().message;
}

TEST(Rokoko, LeftArmDrivesTheLeftArm) {
  const LoadedRobot& loaded = streamed_g1();
  const Robot& robot = *loaded.robot;
  LivePipelineOptions options;
  std::vector<double> qpos;
  LivePipeline pipeline(
      set_up_robot(loaded, options.run).value(), options, decoder_at("udp:1"),
      [&](const RobotFrame& frame) { qpos.assign(frame.qpos.begin(), frame.qpos.end()); },
      [](std::string_view, std::string_view) {});
  // Calibrated with the known T-pose of Studio, not with this frame.
  for (int frame = 0; frame < 120; ++frame) {
    const double now = frame / 60.0;
    const auto taken =
        pipeline.packet(packet_of({actor_of("Ann", left_arm_down())}, 7.0 + now).dump(), now);
    ASSERT_TRUE(taken) << describe(taken.error());
  }
  EXPECT_EQ(pipeline.packets().malformed, 0);
  EXPECT_EQ(pipeline.statistics().lost, 0);
  // Studio's z is -y here, so its left, -x, is x.
  expect_left_arm_down(robot, qpos);
}

TEST(Rokoko, ReportsItsProperties) {
  const auto decoder = decoder_at("udp:1");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(packet_of({actor_of("Ann", actor_pose())}, 12.5).dump(), kept));
  ASSERT_EQ(kept.skeletons.size(), 1U);
  EXPECT_EQ(kept.skeletons[0].origin().body_height, 1.8);
  EXPECT_EQ(kept.skeletons[0].skeleton().joint_count(), 23);
  ASSERT_EQ(kept.frames.size(), 1U);
  EXPECT_EQ(kept.frames[0].time, 12.5);
  // Right-handed: the mirror image of x.
  EXPECT_LT((kept.frames[0].translations[0] - Eigen::Vector3d(0, 0.95, 0)).norm(), 1e-12);
  const int arm = kept.skeletons[0].skeleton().find("leftUpperArm").value();
  EXPECT_GT(kept.skeletons[0].skeleton().joint(arm).offset.x(), 0.1);
  // In the T-pose no joint is rotated.
  for (const auto& rotation : kept.frames[0].rotations) {
    EXPECT_LT(rotation.angularDistance(Eigen::Quaterniond::Identity()), 1e-5);
  }
}

TEST(Rokoko, ToesAndCollarBonesAreOptional) {
  Body body = actor_pose();
  for (const char* bone : {"leftToe", "leftToeEnd", "rightToe", "rightToeEnd", "leftShoulder",
                           "rightShoulder", "neck"}) {
    body.erase(bone);
  }
  const auto decoder = decoder_at("udp:1");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(packet_of({actor_of("Ann", body)}, 1.0).dump(), kept));
  const Skeleton& skeleton = kept.skeletons.at(0).skeleton();
  EXPECT_EQ(skeleton.joint_count(), 16);
  EXPECT_EQ(skeleton.joint(skeleton.find("leftUpperArm").value()).parent,
            skeleton.find("chest").value());
}

TEST(Rokoko, SelectsOneOfSeveralActors) {
  Json gloves = actor_of("Gloves", actor_pose());
  gloves["meta"]["hasBody"] = false;
  const Json ann = actor_of("Ann", actor_pose()), bob = actor_of("Bob", left_arm_down());
  const int arm = 6;
  const auto arm_turns = [&](const std::string& address, const std::vector<Json>& actors) {
    const auto decoder = decoder_at(address);
    KeptStream kept;
    EXPECT_TRUE(decoder->take(packet_of(actors, 1.0).dump(), kept));
    EXPECT_EQ(kept.frames.size(), 1U);
    return kept.frames.at(0).rotations[arm].angularDistance(Eigen::Quaterniond::Identity()) > 1.0;
  };
  EXPECT_FALSE(arm_turns("udp:1", {gloves, ann, bob}));
  EXPECT_TRUE(arm_turns("udp:1?actor=Bob", {gloves, ann, bob}));
  EXPECT_THAT(refusal(packet_of({ann}, 1.0).dump(), "udp:1?actor=Bob"), HasSubstr("Ann"));
  EXPECT_THAT(refusal(packet_of({gloves}, 1.0).dump()), HasSubstr("body"));
  // The order of actors may change: the decoder still follows the same actor.
  const auto decoder = decoder_at("udp:1");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(packet_of({ann, bob}, 1.0).dump(), kept));
  ASSERT_TRUE(decoder->take(packet_of({bob, ann}, 2.0).dump(), kept));
  EXPECT_EQ(kept.skeletons.size(), 1U);
}

// Studio loses people for moments; the robot must not run to another person.
TEST(Rokoko, FollowsAnotherActorOnlyAfterAWhile) {
  const Json ann = actor_of("Ann", actor_pose()), bob = actor_of("Bob", left_arm_down());
  const auto decoder = decoder_at("udp:1");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(packet_of({ann, bob}, 1.0).dump(), kept));
  const auto lost = decoder->take(packet_of({bob}, 1.01).dump(), kept);
  ASSERT_FALSE(lost);
  EXPECT_THAT(lost.error().message, HasSubstr("Ann"));
  ASSERT_TRUE(decoder->take(packet_of({bob, ann}, 1.02).dump(), kept));
  EXPECT_EQ(kept.skeletons.size(), 1U);
  EXPECT_EQ(kept.frames.size(), 2U);
  for (int packet = 0; packet < 100; ++packet) {
    EXPECT_FALSE(decoder->take(packet_of({bob}, 1.03 + 0.01 * packet).dump(), kept));
  }
  ASSERT_TRUE(decoder->take(packet_of({bob}, 3.0).dump(), kept));
  EXPECT_EQ(kept.skeletons.size(), 2U);
  // Another sender may have other actors.
  decoder->restart();
  EXPECT_TRUE(decoder->take(packet_of({ann}, 4.0).dump(), kept));
}

TEST(Rokoko, ReadsVersionTwo) {
  Json actor = actor_of("Ann", actor_pose())["body"];
  actor["id"] = "Ann";
  const Json packet = {{"version", "2,0"},       {"timestamp", 3.5},
                       {"props", Json::array()}, {"trackers", Json::array()},
                       {"faces", Json::array()}, {"actors", {actor}}};
  for (const char* address : {"udp:1", "udp:1?actor=Ann"}) {
    const auto decoder = decoder_at(address);
    KeptStream kept;
    ASSERT_TRUE(decoder->take(packet.dump(), kept));
    ASSERT_EQ(kept.frames.size(), 1U);
    EXPECT_EQ(kept.frames[0].time, 3.5);
  }
}

TEST(Rokoko, RejectsMalformedPackets) {
  EXPECT_THAT(refusal("noise"), HasSubstr("JSON"));
  EXPECT_THAT(refusal("{\"scene\": "), HasSubstr("truncated"));
  EXPECT_THAT(refusal("{\"scene\": 3}"), HasSubstr("actors"));
  EXPECT_THAT(refusal("{\"scene\": nonsense}"), testing::Not(testing::IsEmpty()));
  const Json whole = packet_of({actor_of("Ann", actor_pose())}, 1.0);
  const auto without = [&](const std::function<void(Json&)>& change) {
    Json packet = whole;
    change(packet["scene"]["actors"][0]["body"]);
    return refusal(packet.dump());
  };
  EXPECT_THAT(without([](Json& body) { body.erase("leftLeg"); }), HasSubstr("leftLeg"));
  EXPECT_THAT(without([](Json& body) { body["chest"] = 3; }), HasSubstr("chest"));
  EXPECT_THAT(without([](Json& body) { body["hip"]["position"]["x"] = "0"; }), HasSubstr("hip"));
  EXPECT_THAT(without([](Json& body) { body["hip"]["position"]["x"] = 1e9; }), HasSubstr("hip"));
  EXPECT_THAT(without([](Json& body) {
                body["head"]["rotation"] = {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 0}};
              }),
              HasSubstr("the rotation is zero"));
  // A bone that is missing later only costs its frame.
  const auto decoder = decoder_at("udp:1");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(whole.dump(), kept));
  Json broken = whole;
  broken["scene"]["actors"][0]["body"].erase("neck");
  EXPECT_FALSE(decoder->take(broken.dump(), kept));
  ASSERT_TRUE(decoder->take(whole.dump(), kept));
  EXPECT_EQ(kept.skeletons.size(), 1U);
  EXPECT_EQ(kept.frames.size(), 2U);
}

TEST(Rokoko, JoinsPiecesOfAConnection) {
  std::string bytes;
  for (int frame = 0; frame < 5; ++frame) {
    bytes +=
        packet_of({actor_of("A \"}{\\ nn", actor_pose())}, frame).dump() + (frame % 2 ? "\n" : "");
  }
  for (const std::size_t piece :
       {std::size_t{1}, std::size_t{7}, std::size_t{4000}, bytes.size()}) {
    const auto decoder = decoder_at("tcp:1");
    KeptStream kept;
    for (std::size_t begin = 0; begin < bytes.size(); begin += piece) {
      ASSERT_TRUE(decoder->take(bytes.substr(begin, piece), kept));
    }
    EXPECT_EQ(kept.frames.size(), 5U) << piece;
  }
  // A partial message ends with its connection.
  const auto decoder = decoder_at("tcp:1");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(bytes.substr(0, 900), kept));
  decoder->restart();
  ASSERT_TRUE(decoder->take(bytes, kept));
  EXPECT_EQ(kept.frames.size(), 5U);
}

// An LZ4 frame with one stored block, by its specification (lz4_Frame_format.md): mark, independent
// blocks of 64 KB, checksum of that, size with the highest bit set, end.
std::string stored_in_lz4(const std::string& text) {
  const auto little_endian = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  return "\x04\x22\x4D\x18\x60\x40\x82" +
         little_endian(static_cast<std::uint32_t>(text.size()) | 0x80000000U) + text +
         little_endian(0);
}

TEST(Rokoko, ReadsLz4Frames) {
  const std::string packet = packet_of({actor_of("Ann", actor_pose())}, 1.0).dump();
  const std::string frame = stored_in_lz4(packet);
  if (!Lz4Frame::is_available()) {
    EXPECT_THAT(refusal(frame), HasSubstr("LZ4"));
    GTEST_SKIP() << "this build lacks LZ4";
  }
  for (const char* address : {"udp:1", "tcp:1"}) {
    const auto decoder = decoder_at(address);
    KeptStream kept;
    ASSERT_TRUE(decoder->take(frame, kept));
    ASSERT_TRUE(decoder->take(packet, kept));
    ASSERT_TRUE(decoder->take(frame, kept));
    EXPECT_EQ(kept.frames.size(), 3U) << address;
  }
  const auto connection = decoder_at("tcp:1");
  KeptStream kept;
  for (const char byte : frame + frame + packet) {
    ASSERT_TRUE(connection->take(std::string(1, byte), kept));
  }
  EXPECT_EQ(kept.frames.size(), 3U);
  EXPECT_THAT(refusal(frame.substr(0, frame.size() - 9)), HasSubstr("truncated"));
  std::string broken = frame;
  broken[6] = '\0';
  EXPECT_THAT(refusal(broken), HasSubstr("LZ4"));
}

TEST(JsonCutter, LimitsObjectsToAMegabyte) {
  JsonCutter cutter;
  const std::string endless = "{" + std::string(1 << 16, ' ');
  bool refused = false;
  for (int i = 0; i < 40 && !refused; ++i) {
    std::string_view bytes = i == 0 ? endless : std::string_view(endless).substr(1);
    while (!bytes.empty() && !refused) refused = !cutter.next(bytes);
  }
  EXPECT_TRUE(refused);
  EXPECT_FALSE(cutter.is_inside());
  if (!Lz4Frame::is_available()) return;
  // A literal and a match of 255 times 4,000 bytes, in a block of five kilobytes, four times.
  std::string block = "\x1F{";
  block += std::string("\x01\x00", 2) + std::string(4000, '\xFF') + std::string(1, '\x00');
  block += std::string("\x50") + "aaaaa";
  std::string frame = "\x04\x22\x4D\x18\x60\x70\x73";
  for (int i = 0; i < 4; ++i) {
    for (int shift = 0; shift < 32; shift += 8) frame += static_cast<char>(block.size() >> shift);
    frame += block;
  }
  std::string_view bytes = frame;
  const auto taken = cutter.next(bytes);
  ASSERT_FALSE(taken);
  EXPECT_THAT(taken.error().message, HasSubstr("exceeds the packet size limit"));
}

}  // namespace
}  // namespace retarget
