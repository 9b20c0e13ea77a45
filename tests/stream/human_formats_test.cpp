// Formats with the canonical human: packets decode to the sent world poses and give the robot
// motion of the clip.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "live/stream/human_bones.h"
#include "live/stream/live_pipeline.h"
#include "live/stream/stream_formats.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "stream/stream_support.h"
#include "support/value_of.h"

namespace retarget {
namespace {

Clip bones_of(const Clip& clip) {
  return value_of(clip_of_human_bones(clip, HumanOptions{}, RETARGET_SOURCE_DIR));
}

// Converts formats with y up to z up.
Eigen::Vector3d in_z_up_world(const Clip& clip, const Eigen::Vector3d& place) {
  const bool y_is_up = clip.origin().up && (*clip.origin().up).y() > 0.5;
  return y_is_up ? Eigen::Vector3d(place.x(), -place.z(), place.y()) : place;
}

struct SentBone {
  const char* joint;  // by its name in the stream
  Bone bone;
};

// Positions of the clip's bones against the stream's joints; rotations relative to the T-pose.
void expect_same_world(std::string_view format, const Clip& clip, const std::vector<SentBone>& sent,
                       double metres, double radians) {
  const auto found = value_of(find_stream_format(std::string(format)));
  const auto encoder = found->encoder();
  const auto decoder = found->decoder(parse_address("udp:1").value());
  KeptStream kept;
  const int frames = std::min(40, clip.frame_count());
  if (const std::string header = encoder->begin(clip); !header.empty()) {
    ASSERT_TRUE(decoder->take(header, kept));
  }
  for (int frame = 0; frame < frames; ++frame) {
    const auto bytes = value_of(encoder->frame(clip, frame));
    const auto taken = decoder->take(bytes, kept);
    ASSERT_TRUE(taken) << describe(taken.error());
  }
  ASSERT_EQ(kept.skeletons.size(), 1U);
  // Skeleton recognition knows SMPL's zero pose.
  ASSERT_EQ(kept.rests[0], format != "smplx");
  ASSERT_EQ(kept.frames.size(), static_cast<std::size_t>(frames));
  const Clip& skeleton = kept.skeletons[0];
  Clip back(skeleton.shared_skeleton(), clip.rate(), frames + 1);
  std::ranges::copy(skeleton.rotations(0), back.rotations(frames).begin());
  std::ranges::copy(skeleton.translations(0), back.translations(frames).begin());
  std::vector<Pose> found_poses(static_cast<std::size_t>(back.skeleton().joint_count())),
      rest_poses = found_poses;
  forward_kinematics(back, frames, rest_poses);
  BonePoses bones(clip);
  for (int frame = 0; frame < frames; ++frame) {
    const StreamFrame& streamed = kept.frames[static_cast<std::size_t>(frame)];
    EXPECT_NEAR(streamed.time, clip.rate().time_of(frame), 1e-6);
    std::ranges::copy(streamed.rotations, back.rotations(frame).begin());
    std::ranges::copy(streamed.translations, back.translations(frame).begin());
    forward_kinematics(back, frame, found_poses);
    bones.set_frame(clip, frame);
    for (const SentBone& each : sent) {
      const auto joint = back.skeleton().find(each.joint);
      ASSERT_TRUE(joint) << each.joint;
      const Pose& world = found_poses[static_cast<std::size_t>(*joint)];
      const Pose& expected = bones.world_from_bone(each.bone);
      EXPECT_LT((in_z_up_world(skeleton, world.translation) - expected.translation).norm(), metres)
          << each.joint << " " << frame;
      // The rotation from the T-pose, independent of its axes: its axis and angle.
      const Eigen::AngleAxisd turn(
          world.rotation * rest_poses[static_cast<std::size_t>(*joint)].rotation.conjugate());
      // The T-pose of the stream faces -y and the canonical one faces x; OpenXR's faces +y.
      const double to_left = format == "xrobot" ? -1.0 : 1.0;
      const Eigen::AngleAxisd quarter(to_left * 0.5 * 3.14159265358979323846,
                                      Eigen::Vector3d::UnitZ());
      const Eigen::AngleAxisd expected_turn(expected.rotation * Eigen::Quaterniond(quarter));
      const Eigen::Quaterniond as_found(
          Eigen::AngleAxisd(turn.angle(), in_z_up_world(skeleton, turn.axis())));
      EXPECT_LT(as_found.angularDistance(Eigen::Quaterniond(expected_turn)), radians)
          << each.joint << " " << frame;
    }
  }
}

// Robot configurations by human time, in whole frames, for a clip played in a format; `lines` plays
// it unchanged.
std::map<long, std::vector<double>> followed(const Clip& given, const char* format) {
  const LoadedRobot& robot = streamed_g1();
  const StreamFormat& row = **find_stream_format(format);
  const Clip clip = row.plays_human != nullptr && row.plays_human(given) ? bones_of(given) : given;
  LivePipelineOptions options;
  options.run.human.height = 1.75;
  // One robot frame per human frame, starting with the first complete one.
  options.live.fps = given.rate().fps();
  std::map<long, std::vector<double>> frames;
  LivePipeline pipeline(
      set_up_robot(robot, options.run).value(), options,
      row.decoder(parse_address("udp:1").value()),
      [&](const RobotFrame& frame) {
        frames.try_emplace(std::lround(frame.time * given.rate().fps()), frame.qpos.begin(),
                           frame.qpos.end());
      },
      [](std::string_view, std::string_view) {});
  const auto encoder = row.encoder();
  if (const std::string header = encoder->begin(clip); !header.empty()) {
    EXPECT_TRUE(pipeline.packet(header.substr(0, header.find('\n')), 0.0));
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    std::string bytes = encoder->frame(clip, frame).value();
    if (row.is_text) bytes.pop_back();
    const auto taken = pipeline.packet(bytes, clip.rate().time_of(frame));
    EXPECT_TRUE(taken) << describe(taken.error());
  }
  pipeline.finish(clip.duration());
  EXPECT_EQ(pipeline.packets().malformed, 0) << format;
  return frames;
}

double largest_difference(const std::map<long, std::vector<double>>& a,
                          const std::map<long, std::vector<double>>& b, std::size_t begin) {
  double largest = 0.0;
  EXPECT_GT(a.size(), 100U);
  // In some formats, the second packet also completes the first frame.
  EXPECT_LE(a.size(), b.size() + 1);
  EXPECT_LE(b.size(), a.size());
  for (const auto& [frame, qpos] : b) {
    EXPECT_TRUE(a.contains(frame)) << frame;
    const std::vector<double>& other = a.at(frame);
    // A quaternion and its opposite are the same rotation.
    const double sign =
        std::inner_product(qpos.begin() + 3, qpos.begin() + 7, other.begin() + 3, 0.0) < 0.0 ? -1.0
                                                                                             : 1.0;
    for (std::size_t k = begin; k < qpos.size(); ++k) {
      const bool is_rotation = k >= 3 && k < 7;
      largest = std::max(largest, std::abs(other[k] - (is_rotation ? sign : 1.0) * qpos[k]));
    }
  }
  return largest;
}

const std::vector<SentBone> kVmcBones = {
    {"Hips", Bone::kHips},
    {"UpperChest", Bone::kSpine2},
    {"Head", Bone::kHead},
    {"LeftUpperArm", Bone::kLeftArm},
    {"LeftHand", Bone::kLeftHand},
    {"RightLowerArm", Bone::kRightForeArm},
    {"LeftLowerLeg", Bone::kLeftLeg},
    {"RightFoot", Bone::kRightFoot},
    {"RightToes", Bone::kRightToe},
};
const std::vector<SentBone> kRokokoSent = {
    {"hip", Bone::kHips},
    {"spine", Bone::kSpine},
    {"chest", Bone::kSpine2},
    {"head", Bone::kHead},
    {"leftUpperArm", Bone::kLeftArm},
    {"leftHand", Bone::kLeftHand},
    {"rightLowerArm", Bone::kRightForeArm},
    {"leftLeg", Bone::kLeftLeg},
    {"rightFoot", Bone::kRightFoot},
    {"rightToe", Bone::kRightToe},
};
const std::vector<SentBone> kSmplJoints = {
    {"pelvis", Bone::kHips},         {"spine3", Bone::kSpine2},
    {"head", Bone::kHead},           {"left_shoulder", Bone::kLeftArm},
    {"left_wrist", Bone::kLeftHand}, {"right_elbow", Bone::kRightForeArm},
    {"left_knee", Bone::kLeftLeg},   {"right_ankle", Bone::kRightFoot},
    {"right_foot", Bone::kRightToe},
};
const std::vector<SentBone> kXrobotSent = {
    {"Pelvis", Bone::kHips},         {"Spine3", Bone::kSpine2},
    {"Head", Bone::kHead},           {"Left_Shoulder", Bone::kLeftArm},
    {"Left_Wrist", Bone::kLeftHand}, {"Right_Elbow", Bone::kRightForeArm},
    {"Left_Knee", Bone::kLeftLeg},   {"Right_Ankle", Bone::kRightFoot},
    {"Right_Foot", Bone::kRightToe},
};

TEST(HumanFormats, AllRoundTrip) {
  // A clip with LAFAN1's skeleton, and one with other names, axes and units.
  for (const Clip& clip :
       {sample_clip("walk"), load_clip(RETARGET_SOURCE_DIR "/tests/scene/data/walk.fbx").value()}) {
    const Clip bones = bones_of(clip);
    // VMC uses floats.
    expect_same_world("vmc", bones, kVmcBones, 2e-6, 2e-6);
    expect_same_world("rokoko", bones, kRokokoSent, 1e-9, 1e-7);
    expect_same_world("smplx", bones, kSmplJoints, 1e-9, 1e-7);
    expect_same_world("xrobot", bones, kXrobotSent, 1e-9, 1e-7);
  }
}

TEST(HumanFormats, ProduceTheSameRobotMotionAsLines) {
  for (const char* name : {"walk", "wave"}) {
    const auto lines = followed(sample_clip(name), "lines");
    for (const char* format : {"vmc", "rokoko", "smplx", "xrobot"}) {
      EXPECT_LT(largest_difference(lines, followed(sample_clip(name), format), 0), 1e-3)
          << name << " " << format;
    }
  }
}

}  // namespace
}  // namespace retarget
