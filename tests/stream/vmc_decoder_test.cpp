// VMC: packets of a performer, built byte by byte; sides, axes and frames.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "live/stream/live_pipeline.h"
#include "live/stream/osc.h"
#include "live/stream/stream_formats.h"
#include "retarget/load.h"
#include "stream/stream_support.h"
#include "support/value_of.h"

namespace retarget {
namespace {

std::string big_endian_word(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

std::string osc_message(const std::string& address, const std::string& name,
                        const std::vector<float>& numbers) {
  std::string bytes = osc_text(address);
  bytes += osc_text("," + std::string(name.empty() ? "" : "s") + std::string(numbers.size(), 'f'));
  if (!name.empty()) bytes += osc_text(name);
  for (const float number : numbers) bytes += big_endian_word(std::bit_cast<std::uint32_t>(number));
  return bytes;
}

std::string bundle_of(const std::vector<std::string>& messages) {
  std::string bytes("#bundle\0\0\0\0\0\0\0\0\1", 16);
  for (const std::string& message : messages) {
    bytes += big_endian_word(static_cast<std::uint32_t>(message.size())) + message;
  }
  return bytes;
}

struct VmcBone {
  const char* name;
  std::vector<float> position;
  std::vector<float> rotation = {0, 0, 0, 1};
};

// An avatar in its T-pose: Unity's axes, it faces z, its left is -x.
std::vector<VmcBone> avatar() {
  return {{"Hips", {0, 0.95F, 0}},
          {"Spine", {0, 0.1F, 0}},
          {"Chest", {0, 0.12F, 0}},
          {"Neck", {0, 0.25F, 0}},
          {"Head", {0, 0.1F, 0}},
          {"LeftShoulder", {-0.05F, 0.2F, 0}},
          {"LeftUpperArm", {-0.12F, 0, 0}},
          {"LeftLowerArm", {-0.27F, 0, 0}},
          {"LeftHand", {-0.25F, 0, 0}},
          {"RightShoulder", {0.05F, 0.2F, 0}},
          {"RightUpperArm", {0.12F, 0, 0}},
          {"RightLowerArm", {0.27F, 0, 0}},
          {"RightHand", {0.25F, 0, 0}},
          {"LeftUpperLeg", {-0.09F, -0.05F, 0}},
          {"LeftLowerLeg", {0, -0.42F, 0}},
          {"LeftFoot", {0, -0.4F, 0}},
          {"LeftToes", {0, -0.06F, 0.12F}},
          {"RightUpperLeg", {0.09F, -0.05F, 0}},
          {"RightLowerLeg", {0, -0.42F, 0}},
          {"RightFoot", {0, -0.4F, 0}},
          {"RightToes", {0, -0.06F, 0.12F}}};
}

std::vector<std::string> messages_of(const std::vector<VmcBone>& bones, float time) {
  std::vector<std::string> messages = {
      osc_message("/VMC/Ext/OK", "", {1}), osc_message("/VMC/Ext/T", "", {time}),
      osc_message("/VMC/Ext/Root/Pos", "root", {0, 0, 0, 0, 0, 0, 1})};
  for (const VmcBone& bone : bones) {
    std::vector<float> numbers = bone.position;
    numbers.insert(numbers.end(), bone.rotation.begin(), bone.rotation.end());
    messages.push_back(osc_message("/VMC/Ext/Bone/Pos", bone.name, numbers));
  }
  return messages;
}

// The robot's last frame after two seconds of a pose, with one bundle per frame or single messages.
std::vector<double> followed_bones(const std::vector<VmcBone>& bones, bool bundles, int* frames) {
  const LoadedRobot& robot = streamed_g1();
  LivePipelineOptions options;
  std::vector<double> last;
  *frames = 0;
  LivePipeline pipeline(
      set_up_robot(robot, options.run).value(), options, stream_decoder("vmc"),
      [&](const RobotFrame& frame) {
        ++*frames;
        last.assign(frame.qpos.begin(), frame.qpos.end());
      },
      [](std::string_view, std::string_view) {});
  for (int frame = 0; frame < 120; ++frame) {
    const double now = frame / 60.0;
    std::vector<std::string> packets = messages_of(bones, static_cast<float>(now) + 100.0F);
    if (bundles) packets = {bundle_of(packets)};
    for (const std::string& packet : packets) {
      const auto taken = pipeline.packet(packet, now);
      EXPECT_TRUE(taken) << describe(taken.error());
    }
  }
  EXPECT_EQ(pipeline.packets().malformed, 0);
  EXPECT_EQ(pipeline.packets().skeletons, 1);
  EXPECT_EQ(pipeline.statistics().lost, 0);
  return last;
}

TEST(Vmc, LeftArmDrivesTheLeftArm) {
  std::vector<VmcBone> bones = avatar();
  // 80 degrees about z: the left arm hangs down, the right one does not move.
  for (VmcBone& bone : bones) {
    if (std::string(bone.name) == "LeftUpperArm") bone.rotation = {0, 0, 0.6427876F, 0.7660444F};
  }
  for (const bool bundles : {true, false}) {
    int frames = 0;
    const std::vector<double> qpos = followed_bones(bones, bundles, &frames);
    EXPECT_NEAR(frames, 97, 4) << bundles;
    const LoadedRobot& loaded = streamed_g1();
    // The avatar faces its z, which is -y here, so its left is x.
    expect_left_arm_down(*loaded.robot, qpos);
  }
}

TEST(Vmc, RejectsMalformedPackets) {
  const auto decoder = stream_decoder("vmc");
  class Nothing final : public StreamSink {
    void take_skeleton(Clip, bool) override { ADD_FAILURE(); }
    void take_frame(const StreamFrame&) override { ADD_FAILURE(); }
  } nothing;
  const std::string bone = osc_message("/VMC/Ext/Bone/Pos", "Hips", {0, 0, 0, 0, 0, 0, 1});
  for (const std::string& bad :
       {std::string("x"), std::string("/a"), std::string("/abc\0abc\0", 9),
        bone.substr(0, bone.size() - 2), osc_text("/a") + osc_text(",z"),
        osc_message("/VMC/Ext/Bone/Pos", "Hips", {0, 0, 0}),
        osc_message("/VMC/Ext/Bone/Pos", "Hips", {0, 0, 0, 0, 0, 0, 0}),
        osc_message("/VMC/Ext/Bone/Pos", "Hips", {0, NAN, 0, 0, 0, 0, 1}),
        bundle_of({bundle_of({bundle_of({bundle_of({bundle_of({bone})})})})}),
        osc_text("/a") + osc_text(",b") + big_endian_word(0xFFFFFFFF)}) {
    EXPECT_FALSE(decoder->take(bad, nothing));
  }
  EXPECT_TRUE(decoder->take(osc_message("/VMC/Ext/Blend/Val", "Joy", {0.5F}), nothing));
  EXPECT_TRUE(decoder->take(osc_message("/VMC/Ext/Bone/Pos", "Tail", {1}), nothing));
  // Other messages of a bundle are ignored, packets of other programs are not.
  const std::string tracker = osc_message("/tracking/trackers/1/position", "", {0, 1, 0});
  EXPECT_TRUE(decoder->take(bundle_of({tracker, osc_message("/VMC/Ext/Blend/Val", "Joy", {0.5F})}),
                            nothing));
  EXPECT_FALSE(decoder->take(tracker, nothing));
}

TEST(Osc, KeepsTheOrderOfTextsAndNumbers) {
  const std::string bytes = osc_text("/a") + osc_text(",ihsTfd") + big_endian_word(0xFFFFFFFEU) +
                            std::string(8, '\1') + osc_text("word") +
                            big_endian_word(std::bit_cast<std::uint32_t>(0.5F)) +
                            std::string("\x40\x00\0\0\0\0\0\0", 8);
  // The messages point into the bundle.
  const std::string bundle = bundle_of({bytes, osc_text("/b")});
  const auto messages = value_of(read_osc(bundle));
  ASSERT_EQ(messages.size(), 2U);
  EXPECT_EQ(messages[0].address, "/a");
  EXPECT_THAT(messages[0].texts, testing::ElementsAre("word"));
  EXPECT_THAT(messages[0].numbers, testing::ElementsAre(-2.0, 0.5, 2.0));
  EXPECT_EQ(messages[1].address, "/b");
}

}  // namespace
}  // namespace retarget
