// Body tracking of PICO headsets: poses in XRoboToolkit's form, built from a T-pose; sides, axes,
// times and rejected frames.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "live/stream/live_pipeline.h"
#include "live/stream/stream_formats.h"
#include "retarget/load.h"
#include "retarget/pose.h"
#include "stream/stream_support.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

struct TrackedJoint {
  const char* name;
  int parent;
  Eigen::Vector3d at;  // Position in the T-pose that faces -z, with the right side towards +x.
};

// Indices of OpenXR's XrBodyJointBD.
const std::vector<TrackedJoint> kTracked = {
    {"Pelvis", -1, {0, 0.95, 0}},
    {"Left_Hip", 0, {-0.09, 0.9, 0}},
    {"Right_Hip", 0, {0.09, 0.9, 0}},
    {"Spine1", 0, {0, 1.06, 0}},
    {"Left_Knee", 1, {-0.09, 0.48, 0}},
    {"Right_Knee", 2, {0.09, 0.48, 0}},
    {"Spine2", 3, {0, 1.19, 0}},
    {"Left_Ankle", 4, {-0.09, 0.08, 0}},
    {"Right_Ankle", 5, {0.09, 0.08, 0}},
    {"Spine3", 6, {0, 1.26, 0}},
    {"Left_Foot", 7, {-0.09, 0.02, -0.13}},
    {"Right_Foot", 8, {0.09, 0.02, -0.13}},
    {"Neck", 9, {0, 1.46, 0}},
    {"Left_Collar", 9, {-0.05, 1.4, 0}},
    {"Right_Collar", 9, {0.05, 1.4, 0}},
    {"Head", 12, {0, 1.56, 0}},
    {"Left_Shoulder", 13, {-0.18, 1.4, 0}},
    {"Right_Shoulder", 14, {0.18, 1.4, 0}},
    {"Left_Elbow", 16, {-0.45, 1.4, 0}},
    {"Right_Elbow", 17, {0.45, 1.4, 0}},
    {"Left_Wrist", 18, {-0.7, 1.4, 0}},
    {"Right_Wrist", 19, {0.7, 1.4, 0}},
    {"Left_Hand", 20, {-0.8, 1.4, 0}},
    {"Right_Hand", 21, {0.8, 1.4, 0}},
};

Eigen::Quaterniond quarter_turns(double turns, const Eigen::Vector3d& axis) {
  constexpr double kQuarter = 1.57079632679489661923;
  return Eigen::Quaterniond(Eigen::AngleAxisd(kQuarter * turns, axis));
}

// A person who turned to face +z, with the left arm down.
std::vector<Pose> tracked_poses() {
  const Eigen::Quaterniond round = quarter_turns(2.0, Eigen::Vector3d::UnitY());
  // About the joints' z, which points backwards: from the left side down.
  const Eigen::Quaterniond down = quarter_turns(1.0, Eigen::Vector3d::UnitZ());
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kTracked.size(); ++i) {
    const auto& [name, parent, at] = kTracked[i];
    if (parent < 0) {
      poses.push_back({round, {0.0, at.y(), 0.3}});
      continue;
    }
    const auto above = static_cast<std::size_t>(parent);
    const Pose& from = poses[above];
    poses.push_back({from.rotation, from * Eigen::Vector3d(at - kTracked[above].at)});
    if (std::string(name) == "Left_Shoulder") poses.back().rotation = round * down;
  }
  return poses;
}

std::vector<double> numbers_of(const Pose& pose) {
  const auto& p = pose.translation;
  const auto& q = pose.rotation;
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

// In the form of the Python binding's get_body_joints_pose().
Json rows(const std::vector<Pose>& poses) {
  Json joints = Json::array();
  for (const Pose& pose : poses) joints.push_back(numbers_of(pose));
  return joints;
}

Json line_of(const std::vector<Pose>& poses, double time) {
  return {{"time", time}, {"joints", rows(poses)}};
}

// In the form of the headset's client.
Json client_object(const std::vector<Pose>& poses, std::int64_t nanoseconds) {
  Json joints = Json::array();
  for (const Pose& pose : poses) {
    std::string text;
    for (const double number : numbers_of(pose)) {
      text += (text.empty() ? "" : ",") + Json(number).dump();
    }
    joints.push_back({{"p", text}, {"t", 1}, {"va", "0,0,0,0,0,0"}, {"wva", "0,0,0,0,0,0"}});
  }
  return {{"predictTime", 1.5},
          {"Head", {{"pose", "0,1.6,0,0,0,0,1"}}},
          {"Body", {{"joints", joints}, {"len", 24}}},
          {"timeStampNs", nanoseconds}};
}

TEST(Xrobot, PosesFollowTheJointOrder) {
  const std::vector<Pose> poses = tracked_poses();
  const auto decoder = stream_decoder("xrobot");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(line_of(poses, 12.5).dump(), kept));
  ASSERT_TRUE(decoder->take(line_of(poses, 12.6).dump(), kept));
  ASSERT_EQ(kept.skeletons.size(), 1U);
  EXPECT_TRUE(kept.rests[0]);
  const Skeleton& skeleton = kept.skeletons[0].skeleton();
  ASSERT_EQ(skeleton.joint_count(), 24);
  EXPECT_EQ(kept.skeletons[0].origin().up, Eigen::Vector3d(Eigen::Vector3d::UnitY()));
  EXPECT_EQ(kept.skeletons[0].origin().metres_per_unit, 1.0);
  for (int i = 0; i < 24; ++i) {
    const auto& [name, parent, at] = kTracked[static_cast<std::size_t>(i)];
    EXPECT_EQ(skeleton.joint(i).name, name);
    EXPECT_EQ(skeleton.joint(i).parent, parent);
    if (parent < 0) continue;
    // Bones are those of the T-pose for any first pose.
    const Eigen::Vector3d bone = at - kTracked[static_cast<std::size_t>(parent)].at;
    EXPECT_LT((skeleton.joint(i).offset - bone).norm(), 1e-12) << name;
  }
  ASSERT_EQ(kept.frames.size(), 2U);
  EXPECT_EQ(kept.frames[1].time, 12.6);
  const std::vector<Pose> world = kept.world(1);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_LT(distance(world[i], poses[i]), 1e-7) << i;
}

TEST(Xrobot, ReadsTheClientsObjects) {
  const std::vector<Pose> poses = tracked_poses();
  const Json client = client_object(poses, 7250000000);
  Json of_body = client;
  of_body["Body"]["timeStampNs"] = 8000000000;
  const Json service = {{"functionName", "Tracking"}, {"value", client.dump()}};
  const std::vector<std::pair<Json, double>> lines = {
      {client, 7.25}, {of_body, 8.0}, {service, 7.25}};
  for (const auto& [line, time] : lines) {
    const auto decoder = stream_decoder("xrobot");
    KeptStream kept;
    const auto taken = decoder->take(line.dump(), kept);
    ASSERT_TRUE(taken) << describe(taken.error());
    ASSERT_EQ(kept.frames.size(), 1U);
    EXPECT_NEAR(kept.frames[0].time, time, 1e-9);
    const std::vector<Pose> world = kept.world(0);
    for (std::size_t i = 0; i < 24; ++i) EXPECT_LT(distance(world[i], poses[i]), 1e-7) << i;
  }
  // Without a time, the arrival time is used.
  const auto decoder = stream_decoder("xrobot");
  KeptStream kept;
  ASSERT_TRUE(decoder->take(Json{{"joints", rows(poses)}}.dump(), kept));
  EXPECT_TRUE(std::isnan(kept.frames.at(0).time));
}

TEST(Xrobot, LeftArmDrivesTheLeftArm) {
  const LoadedRobot& robot = streamed_g1();
  LivePipelineOptions options;
  std::vector<double> last;
  std::string told;
  LivePipeline pipeline(
      set_up_robot(robot, options.run).value(), options, stream_decoder("xrobot"),
      [&](const RobotFrame& frame) { last.assign(frame.qpos.begin(), frame.qpos.end()); },
      [&](std::string_view, std::string_view text) { told += std::string(text) + "\n"; });
  for (int frame = 0; frame < 120; ++frame) {
    const double now = frame / 60.0;
    ASSERT_TRUE(pipeline.packet(line_of(tracked_poses(), 100.0 + now).dump(), now));
  }
  EXPECT_EQ(pipeline.packets().malformed, 0);
  EXPECT_THAT(told, Not(HasSubstr("unusual")));
  // The human faces +z, which is -y with z up.
  ASSERT_FALSE(last.empty());
  expect_left_arm_down(*robot.robot, last);
}

TEST(Xrobot, RejectsFramesWithoutABody) {
  const std::vector<Pose> poses = tracked_poses();
  const auto decoder = stream_decoder("xrobot");
  KeptStream kept;
  const auto refusal = [&](const Json& line) {
    const auto taken = decoder->take(line.dump(), kept);
    return taken ? std::string() : taken.error().message;
  };
  // Before tracking begins, all joints are at one position, which must not define the body.
  EXPECT_THAT(refusal(line_of(std::vector<Pose>(24), 0)), HasSubstr("not tracked yet"));
  EXPECT_TRUE(kept.skeletons.empty());
  EXPECT_EQ(refusal(line_of(poses, 0)), "");
  ASSERT_EQ(kept.frames.size(), 1U);

  Json line = line_of(poses, 1);
  line["joints"][18] = {0, 0, 0, 0, 0, 0, 0};
  EXPECT_THAT(refusal(line), HasSubstr("Left_Elbow is not tracked"));
  line["joints"][18] = {0, 0, 0, 0, 0, 1};
  EXPECT_THAT(refusal(line), HasSubstr("Left_Elbow: expected seven numbers"));
  line["joints"][18] = {0, 0, nullptr, 0, 0, 0, 1};
  EXPECT_THAT(refusal(line), HasSubstr("Left_Elbow: expected seven numbers"));
  for (const char* text : {"", "0,0,0,0,0,1", "0,0,0,0,0,0,1,2", "0,0,0,0,0,0,x", "0,0,0,0,nan,0,1",
                           "0,0,0,0,inf,0,1", "0,0,0,0,0,0,1,"}) {
    line["joints"][18] = {{"p", text}};
    EXPECT_THAT(refusal(line), HasSubstr("Left_Elbow: expected seven numbers")) << text;
  }
  line["joints"].erase(18);
  EXPECT_THAT(refusal(line), HasSubstr("a list of 24 poses"));
  EXPECT_THAT(refusal({{"Head", {{"pose", "0,0,0,0,0,0,1"}}}, {"timeStampNs", 1}}),
              HasSubstr("is full body tracking enabled"));
  EXPECT_THAT(refusal({{"functionName", "Tracking"}, {"value", "[1]"}}),
              HasSubstr("\"value\" must be a JSON object"));
  EXPECT_THAT(refusal({{"value", "{"}}), HasSubstr("\"value\" is not JSON"));
  EXPECT_THAT(refusal(Json::array()), HasSubstr("a JSON object"));
  EXPECT_EQ(kept.frames.size(), 1U);
  EXPECT_EQ(refusal(line_of(poses, 2)), "");
  EXPECT_EQ(kept.frames.size(), 2U);
  EXPECT_EQ(kept.skeletons.size(), 1U);
  // Another sender may have another body.
  decoder->restart();
  EXPECT_EQ(refusal(line_of(poses, 3)), "");
  EXPECT_EQ(kept.skeletons.size(), 2U);
}

}  // namespace
}  // namespace retarget
