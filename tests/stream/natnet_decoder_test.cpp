// NatNet: the decoder, with messages of all versions, and the packets of the player.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/stream_formats.h"
#include "retarget/data_folder.h"
#include "stream/natnet_packets.h"
#include "stream/stream_support.h"
#include "support/npz_builder.h"

namespace retarget {
namespace {

using namespace natnet_test;
using testing::ElementsAre;
using testing::HasSubstr;

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

const std::vector<std::size_t> kParents = {0, 3, 0, 2, 0};  // in the order of kBones

std::vector<Pose> local_poses() {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kBones.size(); ++i) {
    poses.push_back({about({1, 0.3, -0.2}, 0.2 * static_cast<double>(i + 1)), kBones[i].offset});
  }
  poses[0].translation = {0.3, 0.93, -0.4};
  return poses;
}

std::vector<Pose> world_poses() {
  const auto local = local_poses();
  std::vector<Pose> world = local;
  for (const std::size_t i : {2UL, 3UL, 1UL, 4UL}) world[i] = world[kParents[i]] * local[i];
  return world;
}

std::unique_ptr<Decoder> natnet_decoder(const std::string& extras = "") {
  return stream_decoder("natnet", parse_address("udp:1511?format=natnet" + extras).value());
}

// The joints of the decoder have another order: parents first.
void expect_world(const KeptStream& kept, std::size_t frame_index,
                  const std::vector<Pose>& expected, double x = 0.0) {
  ASSERT_LT(frame_index, kept.frames.size());
  const auto found = kept.world(frame_index);
  for (std::size_t i = 0; i < kBones.size(); ++i) {
    const auto joint = kept.skeletons.back().skeleton().find(kBones[i].name.substr(5));
    ASSERT_TRUE(joint) << kBones[i].name;
    Pose pose = expected[i];
    pose.translation.x() += x;
    EXPECT_LT(distance(found[static_cast<std::size_t>(*joint)], pose), 2e-6) << kBones[i].name;
  }
}

TEST(NatNet, ReadsAllVersionsInBothCoordinates) {
  for (const Version version : kVersions) {
    for (const bool local : {false, true}) {
      const auto decoder = natnet_decoder();
      KeptStream kept;
      ASSERT_TRUE(decoder->take(server_info(version), kept));
      const auto described = decoder->take(models(version), kept);
      ASSERT_TRUE(described) << describe(described.error()) << version.major << version.minor;
      ASSERT_EQ(kept.skeletons.size(), 1U);
      EXPECT_THAT(kept.skeletons[0].skeleton().names(),
                  ElementsAre("Hip", "LThigh", "LShin", "Ab", "LToe"));
      EXPECT_EQ(kept.skeletons[0].origin().up, Eigen::Vector3d(Eigen::Vector3d::UnitY()));
      EXPECT_EQ(kept.skeletons[0].origin().metres_per_unit, 1.0);
      const auto poses = local ? local_poses() : world_poses();
      const auto taken = decoder->take(frame(version, poses, 12.25), kept);
      ASSERT_TRUE(taken) << describe(taken.error()) << version.major << version.minor;
      expect_world(kept, 0, world_poses());
      EXPECT_EQ(kept.frames[0].time, 12.25);
    }
  }
}

TEST(NatNet, FollowsTheNamedSkeleton) {
  const auto decoder = natnet_decoder("&actor=6&version=4.1");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(models({4, 1}), kept));
  ASSERT_TRUE(decoder->take(frame({4, 1}, world_poses(), 1.0), kept));
  expect_world(kept, 0, world_poses(), 5.0);
  EXPECT_THAT(refusal_of(*natnet_decoder("&actor=8&version=4.1"), models({4, 1})),
              HasSubstr("skeleton 8"));
}

TEST(NatNet, AcceptsGivenCoordinates) {
  const auto decoder = natnet_decoder("&version=3.1&coordinates=local");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(models({3, 1}), kept));
  // The bones are far from their positions.
  auto poses = local_poses();
  for (std::size_t i = 1; i < poses.size(); ++i) poses[i].translation *= 7.0;
  ASSERT_TRUE(decoder->take(frame({3, 1}, poses, 1.0), kept));
  auto world = poses;
  for (const std::size_t i : {2UL, 3UL, 1UL, 4UL}) world[i] = world[kParents[i]] * poses[i];
  expect_world(kept, 0, world);
}

TEST(NatNet, RepeatsRequestsUntilAReply) {
  const auto decoder = natnet_decoder("&server=127.0.0.1");
  KeptStream kept;
  EXPECT_EQ(decoder->request(), std::string("\0\0\5\0Ping\0", 9));
  // Frames that arrive before their description are not an error.
  EXPECT_TRUE(decoder->take(frame({4, 1}, world_poses(), 1.0), kept));
  ASSERT_TRUE(decoder->take(server_info({4, 1}), kept));
  EXPECT_EQ(decoder->request(), std::string("\4\0\0\0", 4));
  EXPECT_TRUE(decoder->take(frame({4, 1}, world_poses(), 1.1), kept));
  EXPECT_TRUE(kept.frames.empty());
  ASSERT_TRUE(decoder->take(models({4, 1}), kept));
  EXPECT_EQ(decoder->request(), std::string("\x0A\0\0\0", 4));
  ASSERT_TRUE(decoder->take(frame({4, 1}, world_poses(), 1.2, true), kept));
  EXPECT_EQ(kept.frames.size(), 1U);
  EXPECT_EQ(decoder->request(), std::string("\4\0\0\0", 4));
  decoder->restart();
  EXPECT_EQ(decoder->request(), std::string("\0\0\5\0Ping\0", 9));
}

TEST(NatNet, ReportsASilentServer) {
  const auto decoder = natnet_decoder("&server=127.0.0.1");
  KeptStream kept;
  EXPECT_EQ(decoder->lack(), "Motive's command port 127.0.0.1:1510 does not answer");
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    const auto taken = decoder->take(frame({4, 1}, world_poses(), i), kept);
    if (taken) continue;
    ++refused;
    EXPECT_THAT(taken.error().message, HasSubstr("127.0.0.1:1510 does not answer"));
  }
  EXPECT_EQ(refused, 150);
  ASSERT_TRUE(decoder->take(server_info({4, 1}), kept));
  EXPECT_EQ(decoder->lack(), "");
}

TEST(NatNet, NamesTheChosenCommandPort) {
  const auto decoder = natnet_decoder("&server=127.0.0.1&command=1570&version=4.1");
  EXPECT_THAT(decoder->lack(), HasSubstr("127.0.0.1:1570"));
  EXPECT_EQ(natnet_decoder()->lack(), "");
}

TEST(NatNet, UsesTheBonesOfAFileWithoutDescriptions) {
  std::vector<Joint> joints;
  using enum Channel;
  // Motive's order with the parent first, as for the bones of the frame.
  for (const std::size_t i : {0UL, 2UL, 3UL, 1UL, 4UL}) {
    const int parent = i == 0 ? -1 : i == 3 ? 1 : i == 1 ? 2 : 0;
    joints.push_back({kBones[i].name,
                      parent,
                      100.0 * kBones[i].offset,
                      {},
                      i == 0 ? std::vector<Channel>{kXPosition, kYPosition, kZPosition, kZRotation,
                                                    kYRotation, kXRotation}
                             : std::vector<Channel>{kZRotation, kYRotation, kXRotation}});
  }
  const auto skeleton = std::make_shared<const Skeleton>(joints);
  const auto in_order = [](const std::vector<Pose>& poses) {
    std::string bones = little_endian_bytes(3, 4) + little_endian_bytes(5, 4);
    for (const std::size_t i : {0UL, 2UL, 3UL, 1UL, 4UL}) bones += body(kBones[i].id, poses[i]);
    std::string bytes =
        little_endian_bytes(1, 4) + std::string(12, '\0') + little_endian_bytes(1, 4) + bones;
    bytes += std::string(12, '\0') + little_endian_bytes(0, 8) +
             little_endian_bytes(std::bit_cast<std::uint64_t>(2.0), 8) + std::string(30, '\0');
    return natnet_message(7, bytes);
  };
  for (const bool local : {false, true}) {
    const auto decoder = natnet_decoder("&version=3.1");
    EXPECT_THAT(refusal_of(*decoder, in_order(world_poses())), HasSubstr("not described"));
    decoder->know_skeleton(skeleton);
    KeptStream kept;
    ASSERT_TRUE(decoder->take(in_order(local ? local_poses() : world_poses()), kept));
    EXPECT_TRUE(kept.skeletons.empty());
    const auto found = kept.world(0, skeleton);
    for (std::size_t joint = 0; joint < joints.size(); ++joint) {
      const std::size_t bone = joint == 0   ? 0
                               : joint == 1 ? 2
                               : joint == 2 ? 3
                               : joint == 3 ? 1
                                            : 4;
      EXPECT_LT((found[joint].translation - 100.0 * world_poses()[bone].translation).norm(), 1e-4);
    }
  }
  const auto decoder = natnet_decoder("&version=3.1");
  decoder->know_skeleton(skeleton);
  auto stretched = local_poses();
  for (auto& pose : stretched) pose.translation = pose.translation * 1.9 + Eigen::Vector3d(1, 0, 1);
  EXPECT_THAT(refusal_of(*decoder, in_order(stretched)),
              HasSubstr("do not match the skeleton file"));
  joints.pop_back();
  decoder->know_skeleton(std::make_shared<const Skeleton>(joints));
  EXPECT_THAT(refusal_of(*decoder, in_order(world_poses())), HasSubstr("4 joints"));
}

TEST(NatNet, RejectsMalformedPackets) {
  const auto decoder = natnet_decoder();
  KeptStream kept;
  EXPECT_THAT(refusal_of(*decoder, "abc"), HasSubstr("not a NatNet message"));
  EXPECT_THAT(refusal_of(*decoder, natnet_message(55, "")), HasSubstr("not a NatNet message"));
  EXPECT_THAT(refusal_of(*decoder, frame({4, 1}, world_poses(), 1)), HasSubstr("version"));
  EXPECT_THAT(refusal_of(*decoder, models({4, 1})), HasSubstr("version"));
  EXPECT_THAT(refusal_of(*decoder, server_info({2, 10})), HasSubstr("3.0"));
  EXPECT_THAT(refusal_of(*decoder, server_info({4, 1}).substr(0, 200)), HasSubstr("truncated"));
  ASSERT_TRUE(decoder->take(server_info({4, 1}), kept));
  EXPECT_THAT(refusal_of(*decoder, natnet_message(5, little_endian_bytes(0, 4))),
              HasSubstr("no skeleton: enable"));
  const auto with = [](int bone, int id, int parent) {
    auto bones = kBones;
    bones[static_cast<std::size_t>(bone)].id = id;
    bones[static_cast<std::size_t>(bone)].parent = parent;
    return models({4, 1}, bones);
  };
  EXPECT_THAT(refusal_of(*decoder, with(4, 2, 1)), HasSubstr("same ID"));
  EXPECT_THAT(refusal_of(*decoder, with(4, 5, 0)), HasSubstr("no parent"));
  EXPECT_THAT(refusal_of(*decoder, with(0, 1, 4)), HasSubstr("without a valid parent"));
  ASSERT_TRUE(decoder->take(models({4, 1}), kept));
  auto poses = world_poses();
  poses[2].translation.y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of(*decoder, frame({4, 1}, poses, 1)), HasSubstr("pose"));
  poses = world_poses();
  poses.pop_back();
  EXPECT_THAT(refusal_of(*decoder, frame({4, 1}, poses, 1)), HasSubstr("Ab"));
  for (const Version version : kVersions) {
    const auto other = natnet_decoder();
    ASSERT_TRUE(other->take(server_info(version), kept));
    ASSERT_TRUE(other->take(models(version), kept));
    const std::string good = frame(version, world_poses(), 1);
    for (std::size_t size = 4; size + 40 < good.size(); size += 3) {
      std::string bytes = good.substr(0, size);
      bytes.replace(2, 2, little_endian_bytes(size - 4, 2));
      EXPECT_FALSE(other->take(bytes, kept)) << size;
    }
  }
  // The frame contains no tracked body.
  const std::size_t frames = kept.frames.size();
  EXPECT_TRUE(decoder->take(frame({4, 1}, world_poses(), 1, false, false), kept));
  EXPECT_EQ(kept.frames.size(), frames);
}

TEST(NatNetPlayer, RoundTripsAllJoints) {
  const std::string folder = find_data_folder(std::nullopt).value().string();
  const Clip clip = clip_with_units(sample_clip("walk"), {}, folder).value();
  EXPECT_EQ(clip.origin().metres_per_unit, 0.01);
  const auto encoder = stream_encoder("natnet");
  const std::string header = encoder->begin(clip);
  // In pieces, as from a pipe.
  const auto decoder = stream_decoder("natnet", parse_address("stdin?format=natnet").value());
  KeptStream kept;
  std::string bytes = header;
  for (int index = 0; index < clip.frame_count(); ++index) {
    bytes += encoder->frame(clip, index).value();
  }
  for (std::size_t at = 0; at < bytes.size(); at += 1001) {
    const auto taken = decoder->take(std::string_view(bytes).substr(at, 1001), kept);
    ASSERT_TRUE(taken) << describe(taken.error());
  }
  ASSERT_EQ(kept.skeletons.size(), 1U);
  EXPECT_EQ(kept.skeletons[0].skeleton().names(), clip.skeleton().names());
  ASSERT_EQ(kept.frames.size(), static_cast<std::size_t>(clip.frame_count()));
  std::vector<Pose> expected(static_cast<std::size_t>(clip.skeleton().joint_count()));
  for (int index = 0; index < clip.frame_count(); ++index) {
    forward_kinematics(clip, index, expected);
    const auto found = kept.world(static_cast<std::size_t>(index));
    EXPECT_EQ(kept.frames[static_cast<std::size_t>(index)].time, clip.rate().time_of(index));
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const Pose metric = {expected[i].rotation, 0.01 * expected[i].translation};
      EXPECT_LT(distance(found[i], metric), 2e-6) << index;
    }
  }
}

TEST(NatNetPlayer, RepliesToItsReceivers) {
  const std::string folder = find_data_folder(std::nullopt).value().string();
  const Clip clip = clip_with_units(sample_clip("wave"), {}, folder).value();
  const auto encoder = stream_encoder("natnet");
  EXPECT_FALSE(encoder->begin(clip).empty());
  const auto decoder = natnet_decoder("&server=127.0.0.1");
  KeptStream kept;
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(decoder->take(encoder->answer(decoder->request()), kept));
  }
  EXPECT_EQ(kept.skeletons.size(), 1U);
  EXPECT_EQ(encoder->answer(decoder->request()), "");
  EXPECT_EQ(encoder->answer(natnet_message(2, text("Bitstream"))),
            natnet_message(3, "Bitstream,4.1"));
  EXPECT_EQ(encoder->answer(natnet_message(2, text("FrameRate"))), natnet_message(100, ""));
  EXPECT_EQ(encoder->answer("?"), "");
}

}  // namespace
}  // namespace retarget
