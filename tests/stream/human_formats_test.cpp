// Formats that play the canonical human: what is sent comes back as the same poses in the world, and
// moves a robot as the clip itself does.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motion/forward_kinematics.h"
#include "retarget/load.h"
#include "stream/formats.h"
#include "stream/human_bones.h"
#include "stream/live_pipeline.h"

namespace retarget {
namespace {

Clip sample(const std::string& name) {
  return load_clip(RETARGET_SOURCE_DIR "/data/" + name + ".bvh").value();
}

Clip bones_of(const Clip& clip) {
  auto bones = clip_of_human_bones(clip, HumanOptions{}, RETARGET_SOURCE_DIR);
  EXPECT_TRUE(bones) << describe(bones.error());
  return *bones;
}

class Kept final : public StreamSink {
 public:
  void take_skeleton(Clip clip, bool has_rest) override {
    skeletons.push_back(std::move(clip));
    rests.push_back(has_rest);
  }
  void take_frame(const StreamFrame& frame) override { frames.push_back(frame); }

  std::vector<Clip> skeletons;
  std::vector<bool> rests;
  std::vector<StreamFrame> frames;
};

// z up from y up, where it is that
Eigen::Vector3d in_z_up_world(const Clip& clip, const Eigen::Vector3d& place) {
  const bool y_is_up = clip.origin().up && (*clip.origin().up).y() > 0.5;
  return y_is_up ? Eigen::Vector3d(place.x(), -place.z(), place.y()) : place;
}

struct SentBone {
  const char* joint;  // by its name in the stream
  Bone bone;
};

// Positions of the clip's bones against those of the stream's joints; rotations from the T-pose.
void expect_same_world(std::string_view format, const Clip& clip, const std::vector<SentBone>& sent,
                       double metres, double radians) {
  const auto found = find_stream_format(std::string(format));
  ASSERT_TRUE(found);
  const auto encoder = (*found)->encoder();
  const auto decoder = (*found)->decoder(parse_address("udp:1").value());
  Kept kept;
  const int frames = std::min(40, clip.frame_count());
  if (const std::string header = encoder->begin(clip); !header.empty()) {
    ASSERT_TRUE(decoder->take(header, kept));
  }
  for (int frame = 0; frame < frames; ++frame) {
    const auto bytes = encoder->frame(clip, frame);
    ASSERT_TRUE(bytes) << describe(bytes.error());
    const auto taken = decoder->take(*bytes, kept);
    ASSERT_TRUE(taken) << describe(taken.error());
  }
  ASSERT_EQ(kept.skeletons.size(), 1U);
  // SMPL's zero pose is known to recognition
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
      // from the T-pose, whatever the axes in it: what it turns about and how far
      const Eigen::AngleAxisd turn(
          world.rotation * rest_poses[static_cast<std::size_t>(*joint)].rotation.conjugate());
      // the T-pose of the stream faces -y where the canonical one faces x
      const Eigen::AngleAxisd quarter(0.5 * 3.14159265358979323846, Eigen::Vector3d::UnitZ());
      const Eigen::AngleAxisd expected_turn(expected.rotation * Eigen::Quaterniond(quarter));
      const Eigen::Quaterniond as_found(
          Eigen::AngleAxisd(turn.angle(), in_z_up_world(skeleton, turn.axis())));
      EXPECT_LT(as_found.angularDistance(Eigen::Quaterniond(expected_turn)), radians)
          << each.joint << " " << frame;
    }
  }
}

// the robot's configurations while a clip is played in a format; `lines` plays it as it is
std::vector<std::vector<double>> followed(const Clip& given, const char* format) {
  static const LoadedRobot robot =
      load_robot({"unitree_g1", {}, {}, {}}, DataFolder{RETARGET_SOURCE_DIR, {}}).value();
  const StreamFormat& row = **find_stream_format(format);
  const Clip clip = row.plays_human != nullptr && row.plays_human(given) ? bones_of(given) : given;
  LivePipelineOptions options;
  options.run.human.height = 1.75;
  std::vector<std::vector<double>> frames;
  LivePipeline pipeline(
      set_up_robot(robot, options.run).value(), options,
      row.decoder(parse_address("udp:1").value()),
      [&](const RobotFrame& frame) { frames.emplace_back(frame.qpos.begin(), frame.qpos.end()); },
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

double largest_difference(const std::vector<std::vector<double>>& a,
                          const std::vector<std::vector<double>>& b, std::size_t begin) {
  double largest = 0.0;
  EXPECT_GT(a.size(), 100U);
  EXPECT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    for (std::size_t k = begin; k < a[i].size(); ++k) {
      largest = std::max(largest, std::abs(a[i][k] - b[i][k]));
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

TEST(HumanFormats, ComeBack) {
  // of LAFAN1's skeleton, and of one with other names, axes and units
  for (const Clip& clip :
       {sample("walk"), load_clip(RETARGET_SOURCE_DIR "/tests/scene/data/walk.fbx").value()}) {
    const Clip bones = bones_of(clip);
    // numbers of VMC are floats
    expect_same_world("vmc", bones, kVmcBones, 2e-6, 2e-6);
    expect_same_world("rokoko", bones, kRokokoSent, 1e-9, 1e-7);
    expect_same_world("smplx", bones, kSmplJoints, 1e-9, 1e-7);
  }
}

TEST(HumanFormats, ARobotFollowsThemAsItFollowsLines) {
  for (const char* name : {"walk", "wave"}) {
    const auto lines = followed(sample(name), "lines");
    for (const char* format : {"vmc", "rokoko", "smplx"}) {
      EXPECT_LT(largest_difference(lines, followed(sample(name), format), 0), 1e-3)
          << name << " " << format;
    }
  }
}

}  // namespace
}  // namespace retarget
