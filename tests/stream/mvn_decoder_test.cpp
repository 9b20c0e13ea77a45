// Xsens MVN: messages according to the specification, built byte by byte; and the packets of the
// player.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/mvn_protocol.h"
#include "live/stream/stream_formats.h"
#include "retarget/data_folder.h"
#include "stream/stream_support.h"

namespace retarget {
namespace {

using testing::HasSubstr;

std::string big_endian(std::uint64_t value, int size) {
  std::string bytes;
  for (int i = size; i-- > 0;) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}

std::string number(double value) {
  return big_endian(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
}

struct Header {
  std::string type = "02";
  std::uint32_t sample = 7;
  int part = 0x80;
  std::uint32_t milliseconds = 1500;
  int actor = 0;
};

// MV0305P 2.4.1
std::string message(const Header& header, int items, const std::string& payload) {
  return "MXTP" + header.type + big_endian(header.sample, 4) +
         big_endian(static_cast<std::uint64_t>(header.part), 1) +
         big_endian(static_cast<std::uint64_t>(items), 1) + big_endian(header.milliseconds, 4) +
         big_endian(static_cast<std::uint64_t>(header.actor), 1) + big_endian(23, 1) +
         big_endian(1, 1) + big_endian(0, 1) + big_endian(0, 2) + big_endian(payload.size(), 2) +
         payload;
}

// Section 2.5.3.
std::string pose_item(int id, const Pose& pose) {
  std::string bytes = big_endian(static_cast<std::uint64_t>(id), 4);
  for (const double value : pose.translation) bytes += number(value);
  bytes += number(pose.rotation.w());
  for (const double value : pose.rotation.vec()) bytes += number(value);
  return bytes;
}

// A body in a T-pose, in segment order, metres; rotated as a whole about z and moved.
std::vector<Eigen::Vector3d> t_pose() {
  return {{0, 0, 0.95},       {-0.01, 0, 1.05},     {0, 0, 1.15},        {0.01, 0, 1.25},
          {0, 0, 1.35},       {0, 0, 1.49},         {0.02, 0, 1.58},     {0, -0.03, 1.44},
          {0, -0.17, 1.45},   {0, -0.46, 1.44},     {0.01, -0.71, 1.43}, {0, 0.03, 1.44},
          {0, 0.17, 1.44},    {0, 0.47, 1.44},      {0, 0.72, 1.44},     {0, -0.09, 0.92},
          {0.01, -0.09, 0.5}, {-0.02, -0.09, 0.09}, {0.15, -0.09, 0.02}, {0, 0.09, 0.92},
          {0, 0.1, 0.51},     {-0.02, 0.1, 0.09},   {0.16, 0.1, 0.02}};
}

std::vector<Pose> turned(double angle) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  std::vector<Pose> poses;
  for (const Eigen::Vector3d& place : t_pose()) {
    poses.push_back({turn, Eigen::Vector3d(1, 2, 0) + turn * place});
  }
  return poses;
}

std::string frame_message(const Header& header, const std::vector<Pose>& poses) {
  std::string payload;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    payload += pose_item(static_cast<int>(i) + 1, poses[i]);
  }
  // A prop after the body.
  payload += pose_item(25, Pose{});
  return message(header, 24, payload);
}

// Section 2.6.2; names in MVN's spelling, with blanks.
std::string scale_message(Header header, const std::vector<Eigen::Vector3d>& places) {
  header.type = "13";
  std::string payload = big_endian(24, 4);
  for (std::size_t i = 0; i < 24; ++i) {
    std::string name = i < 23 ? std::string(kMvnSegments[i].name) : "Prop1";
    if (name == "RightForeArm") name = "Right Forearm";
    payload += big_endian(name.size(), 4) + name;
    for (const double value : i < 23 ? places[i] : Eigen::Vector3d(0, 0, 0))
      payload += number(value);
  }
  payload += big_endian(1, 4) + big_endian(1, 2) + big_endian(13, 2) + big_endian(6, 4) + "Sacrum" +
             big_endian(0, 4) + number(0.1) + number(0.2) + number(0.3);
  return message(header, 1, payload);
}

std::unique_ptr<Decoder> decoder_of(const char* address = "udp:9763?format=mvn") {
  return stream_decoder("mvn", parse_address(address).value());
}

void expect_frames(const KeptStream& kept, const std::vector<std::vector<Pose>>& expected) {
  ASSERT_EQ(kept.frames.size(), expected.size());
  for (std::size_t frame = 0; frame < expected.size(); ++frame) {
    const auto found = kept.world(frame);
    for (std::size_t i = 0; i < expected[frame].size(); ++i) {
      EXPECT_LT(distance(found[i], expected[frame][i]), 1e-6) << frame << kMvnSegments[i].name;
    }
  }
}

TEST(Mvn, ScaleDataAreTheTPose) {
  const auto decoder = decoder_of();
  KeptStream kept;
  ASSERT_TRUE(decoder->take(scale_message({}, t_pose()), kept));
  ASSERT_TRUE(decoder->take(scale_message({}, t_pose()), kept));
  ASSERT_EQ(kept.skeletons.size(), 1U);
  EXPECT_TRUE(kept.rests[0]);
  const Clip& clip = kept.skeletons[0];
  EXPECT_EQ(clip.origin().metres_per_unit, 1.0);
  EXPECT_EQ(clip.origin().up, Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(clip.skeleton().joint(9).name, "RightForeArm");
  EXPECT_LT((clip.skeleton().joint(9).offset - (t_pose()[9] - t_pose()[8])).norm(), 1e-6);
  ASSERT_TRUE(decoder->take(frame_message({}, turned(0.4)), kept));
  expect_frames(kept, {turned(0.4)});
  EXPECT_DOUBLE_EQ(kept.frames[0].time, 1.5);
}

TEST(Mvn, WithoutScaleDataAFrameDeterminesTheLengths) {
  const auto decoder = decoder_of();
  KeptStream kept;
  Header header;
  for (; header.milliseconds < 3500; header.milliseconds += 500) {
    ASSERT_TRUE(decoder->take(frame_message(header, turned(0.7)), kept));
    EXPECT_TRUE(kept.skeletons.empty());
  }
  ASSERT_TRUE(decoder->take(frame_message(header, turned(0.9)), kept));
  ASSERT_EQ(kept.skeletons.size(), 1U);
  EXPECT_TRUE(kept.rests[0]);
  EXPECT_LT((kept.skeletons[0].skeleton().joint(12).offset - (t_pose()[12] - t_pose()[11])).norm(),
            1e-6);
  expect_frames(kept, {turned(0.9)});
  // Late scale data of the same body change nothing; those of another body do.
  ASSERT_TRUE(decoder->take(scale_message({}, t_pose()), kept));
  EXPECT_EQ(kept.skeletons.size(), 1U);
  auto larger = t_pose();
  for (auto& place : larger) place *= 1.3;
  ASSERT_TRUE(decoder->take(scale_message({}, larger), kept));
  EXPECT_EQ(kept.skeletons.size(), 2U);
}

TEST(Mvn, AcceptsFramePartsInAnyOrder) {
  const auto poses = turned(0.2);
  const auto part = [&](std::uint32_t sample, int counter, std::size_t from, std::size_t to) {
    std::string payload;
    for (std::size_t i = from; i < to; ++i) payload += pose_item(static_cast<int>(i) + 1, poses[i]);
    Header header;
    header.sample = sample;
    header.part = counter;
    return message(header, static_cast<int>(to - from), payload);
  };
  const auto decoder = decoder_of();
  KeptStream kept;
  ASSERT_TRUE(decoder->take(scale_message({}, t_pose()), kept));
  ASSERT_TRUE(decoder->take(part(1, 0x82, 20, 23), kept));
  ASSERT_TRUE(decoder->take(part(1, 0, 0, 9), kept));
  EXPECT_TRUE(kept.frames.empty());
  ASSERT_TRUE(decoder->take(part(1, 1, 9, 20), kept));
  expect_frames(kept, {poses});
  ASSERT_TRUE(decoder->take(part(1, 1, 9, 20), kept));
  // A part that never arrives costs one frame, which is reported.
  ASSERT_TRUE(decoder->take(part(2, 0, 0, 9), kept));
  EXPECT_THAT(refusal_of(*decoder, part(3, 0, 0, 9)), HasSubstr("is missing"));
  ASSERT_TRUE(decoder->take(part(3, 0x81, 9, 23), kept));
  expect_frames(kept, {poses, poses});
}

TEST(Mvn, FollowsTheFirstOrTheNamedActor) {
  const auto first = decoder_of();
  const auto named = decoder_of("udp:9763?format=mvn&actor=2");
  KeptStream of_first, of_named;
  for (const int actor : {1, 2, 1, 2}) {
    Header header;
    header.actor = actor;
    for (const std::string& bytes :
         {scale_message(header, t_pose()), frame_message(header, turned(actor))}) {
      ASSERT_TRUE(first->take(bytes, of_first));
      ASSERT_TRUE(named->take(bytes, of_named));
    }
  }
  expect_frames(of_first, {turned(1), turned(1)});
  expect_frames(of_named, {turned(2), turned(2)});
}

TEST(Mvn, SplitsMessagesOfAConnection) {
  const auto decoder = decoder_of("tcp:9763?format=mvn");
  KeptStream kept;
  const std::string bytes = scale_message({}, t_pose()) + frame_message({}, turned(0.1)) +
                            message({"24"}, 1, std::string(12, '\0')) +
                            frame_message({}, turned(0.2)) + frame_message({}, turned(0.3));
  for (const char byte : bytes) ASSERT_TRUE(decoder->take(std::string_view(&byte, 1), kept));
  expect_frames(kept, {turned(0.1), turned(0.2), turned(0.3)});
  // Noise, and the response to it.
  EXPECT_FALSE(decoder->take("MXTPxx noise" + frame_message({}, turned(0.4)), kept));
  ASSERT_TRUE(decoder->take(frame_message({}, turned(0.5)), kept));
  expect_frames(kept, {turned(0.1), turned(0.2), turned(0.3), turned(0.4), turned(0.5)});
}

TEST(Mvn, RejectsMalformedPackets) {
  const auto decoder = decoder_of();
  KeptStream kept;
  ASSERT_TRUE(decoder->take(scale_message({}, t_pose()), kept));
  const std::string good = frame_message({}, turned(0.1));
  EXPECT_THAT(refusal_of(*decoder, "x"), HasSubstr("not a message"));
  EXPECT_THAT(refusal_of(*decoder, "MXTP0" + good.substr(5, 3)), HasSubstr("not a message"));
  EXPECT_THAT(refusal_of(*decoder, good.substr(0, 700)), HasSubstr("truncated"));
  EXPECT_THAT(refusal_of(*decoder, message({"01"}, 1, std::string(28, '\0'))),
              HasSubstr("Quaternion"));
  EXPECT_THAT(refusal_of(*decoder, message({"05"}, 1, std::string(32, '\0'))),
              HasSubstr("Quaternion"));
  EXPECT_THAT(refusal_of(*decoder, message({}, 1, std::string(31, '\0'))), HasSubstr("truncated"));
  EXPECT_THAT(refusal_of(*decoder, message({}, 1, pose_item(1, Pose{}))), HasSubstr("L5"));
  auto poses = turned(0.1);
  poses[3].translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal_of(*decoder, frame_message({}, poses)), HasSubstr("T12"));
  poses = turned(0.1);
  poses[6].rotation.coeffs().setZero();
  EXPECT_THAT(refusal_of(*decoder, frame_message({}, poses)), HasSubstr("Head"));
  Header scale;
  scale.type = "13";
  EXPECT_THAT(refusal_of(*decoder, message(scale, 1, big_endian(0xFFFFFFFF, 4))),
              HasSubstr("truncated"));
  // Meta data and time messages are ignored.
  EXPECT_TRUE(decoder->take(message({"12"}, 1, "name:Anna\n"), kept));
  EXPECT_TRUE(decoder->take(message({"25"}, 1, "10:00:00.000"), kept));
  ASSERT_TRUE(decoder->take(good, kept));
  expect_frames(kept, {turned(0.1)});
}

// A network or a program may damage any of them.
TEST(Mvn, OneWrongNumberInScaleDataIsABadPacket) {
  const auto decoder = decoder_of();
  KeptStream kept;
  ASSERT_TRUE(decoder->take(scale_message({}, t_pose()), kept));
  for (std::size_t segment = 0; segment < kMvnSegmentCount; ++segment) {
    for (const double wrong : {9.0, -3.0, 1e30, std::numeric_limits<double>::quiet_NaN()}) {
      auto places = t_pose();
      places[segment].y() = wrong;
      ASSERT_FALSE(decoder->take(scale_message({}, places), kept)) << segment << ": " << wrong;
    }
  }
  EXPECT_EQ(kept.skeletons.size(), 1U);
  // A frame may not state such sizes either.
  const auto without_scale = decoder_of();
  KeptStream learnt;
  auto poses = turned(0.1);
  poses[9].translation.y() = 9.0;
  Header header;
  ASSERT_TRUE(without_scale->take(frame_message(header, turned(0.1)), learnt));
  header.milliseconds += 3000;
  EXPECT_THAT(refusal_of(*without_scale, frame_message(header, poses)), HasSubstr("person"));
  ASSERT_TRUE(without_scale->take(frame_message(header, turned(0.1)), learnt));
  EXPECT_EQ(learnt.skeletons.size(), 1U);
  ASSERT_TRUE(decoder->take(frame_message({}, turned(0.4)), kept));
  expect_frames(kept, {turned(0.4)});
}

TEST(Mvn, AcceptsAFileInAnotherUnit) {
  std::vector<Joint> joints;
  using enum Channel;
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    const int parent = kMvnSegments[i].parent;
    const Eigen::Vector3d from =
        parent < 0 ? Eigen::Vector3d(0, 0, 0) : t_pose()[static_cast<std::size_t>(parent)];
    std::vector<Channel> channels = {kZRotation, kYRotation, kXRotation};
    if (parent < 0) channels.insert(channels.begin(), {kXPosition, kYPosition, kZPosition});
    joints.push_back(
        {std::string(kMvnSegments[i].name), parent, 100.0 * (t_pose()[i] - from), {}, channels});
  }
  const auto skeleton = std::make_shared<const Skeleton>(joints);
  const auto decoder = decoder_of();
  decoder->know_skeleton(skeleton);
  KeptStream kept;
  ASSERT_TRUE(decoder->take(frame_message({}, turned(0.3)), kept));
  ASSERT_TRUE(decoder->take(scale_message({}, t_pose()), kept));
  EXPECT_TRUE(kept.skeletons.empty());
  ASSERT_EQ(kept.frames.size(), 1U);
  const auto found = kept.world(0, skeleton);
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    EXPECT_LT((found[i].translation - 100.0 * turned(0.3)[i].translation).norm(), 1e-4);
  }
}

// Plays the sender's output message by message.
void play_to(Decoder& decoder, const Encoder& encoder, std::string_view bytes, KeptStream& kept) {
  while (!bytes.empty()) {
    const std::size_t size = encoder.packet_size(bytes);
    ASSERT_TRUE(decoder.take(bytes.substr(0, size), kept));
    bytes.remove_prefix(size);
  }
}

TEST(MvnPlayer, SendsTheHumanOfAnyClip) {
  const Clip clip = sample_clip("walk");
  ASSERT_TRUE(format_of("mvn").plays_human(clip));
  const std::string folder = find_data_folder(std::nullopt).value().string();
  const Clip human = clip_of_human_bones(clip, {}, folder).value();
  const auto encoder = stream_encoder("mvn");
  const auto decoder = decoder_of();
  KeptStream kept;
  play_to(*decoder, *encoder, encoder->begin(human), kept);
  ASSERT_EQ(kept.skeletons.size(), 1U);
  BonePoses bones(human);
  for (int frame = 0; frame < human.frame_count(); frame += 7) {
    play_to(*decoder, *encoder, encoder->frame(human, frame).value(), kept);
    bones.set_frame(human, frame);
    const auto found = kept.world(kept.frames.size() - 1);
    for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
      EXPECT_LT(distance(found[i], bones.world_from_bone(kMvnSegments[i].bone)), 2e-6);
    }
    EXPECT_NEAR(kept.frames.back().time, human.rate().time_of(frame), 0.00051);
  }
  EXPECT_EQ(kept.skeletons.size(), 1U);
  // The T-pose: arms horizontally sideways.
  const Clip rest(kept.skeletons[0].shared_skeleton(), FrameRate{}, 1);
  std::vector<Pose> pose(kMvnSegmentCount);
  forward_kinematics(rest, 0, pose);
  const Eigen::Vector3d arms = pose[14].translation - pose[10].translation;
  EXPECT_GT(arms.y(), 1.0);
  EXPECT_LT(std::abs(arms.z()), 0.05);
}

TEST(MvnPlayer, SendsTheSegmentsOfAnMvnClip) {
  // Y up and centimetres, and one additional joint.
  std::vector<Joint> joints;
  using enum Channel;
  const std::vector<Channel> all = {kXPosition, kYPosition, kZPosition,
                                    kZRotation, kYRotation, kXRotation};
  const Eigen::Quaterniond y_up(Eigen::AngleAxisd(-std::acos(0.0), Eigen::Vector3d::UnitX()));
  const auto places = t_pose();
  for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
    const int parent = kMvnSegments[i].parent;
    const Eigen::Vector3d from =
        parent < 0 ? Eigen::Vector3d(0, 0, 0) : places[static_cast<std::size_t>(parent)];
    joints.push_back(
        {std::string(kMvnSegments[i].name), parent, 100.0 * (y_up * (places[i] - from)), {}, all});
  }
  joints.push_back({"Hat", 6, {0, 10, 0}, {}, all});
  Clip clip(std::make_shared<const Skeleton>(joints), FrameRate{50, 1}, 2);
  clip.rotations(1)[0] = Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY());
  clip.rotations(1)[8] = Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitX());
  EXPECT_TRUE(format_of("mvn").plays_human(clip));
  ClipOrigin origin;
  origin.metres_per_unit = 0.01;
  origin.up = Eigen::Vector3d::UnitY();
  clip.set_origin(origin);
  ASSERT_FALSE(format_of("mvn").plays_human(clip));
  const auto encoder = stream_encoder("mvn");
  const auto decoder = decoder_of();
  KeptStream kept;
  play_to(*decoder, *encoder, encoder->begin(clip), kept);
  for (std::size_t i = 1; i < kMvnSegmentCount; ++i) {
    const Eigen::Vector3d from = places[static_cast<std::size_t>(kMvnSegments[i].parent)];
    EXPECT_LT((kept.skeletons[0].skeleton().joint(static_cast<int>(i)).offset - (places[i] - from))
                  .norm(),
              1e-6);
  }
  for (int frame = 0; frame < 2; ++frame) {
    play_to(*decoder, *encoder, encoder->frame(clip, frame).value(), kept);
    std::vector<Pose> expected(24);
    forward_kinematics(clip, frame, expected);
    const auto found = kept.world(static_cast<std::size_t>(frame));
    for (std::size_t i = 0; i < kMvnSegmentCount; ++i) {
      const Pose metric = {y_up.conjugate() * expected[i].rotation * y_up,
                           0.01 * (y_up.conjugate() * expected[i].translation)};
      EXPECT_LT(distance(found[i], metric), 2e-6) << kMvnSegments[i].name;
    }
  }
}

}  // namespace
}  // namespace retarget
