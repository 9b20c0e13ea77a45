// For motions of any skeleton, the robot's limbs must have the human's directions: thighs, shins,
// upper arms, forearms, trunk, hip and shoulder line, measured only from joint positions.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <set>

#include "formats/bvh/read_bvh.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/recognise.h"
#include "retarget/resample.h"
#include "solve/targets/solve_frames.h"
#include "support/load_smpl.h"
#include "support/shared_data.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Ends of a segment: midpoints of two points each.
struct Segment {
  const char* name;
  std::array<const char*, 2> human_from, human_to;
  std::array<const char*, 2> robot_from, robot_to;
};

constexpr std::array<Segment, 11> kSegments = {{
    {"left thigh",
     {"LeftUpLeg", "LeftUpLeg"},
     {"LeftLeg", "LeftLeg"},
     {"left_hip_roll_link", "left_hip_roll_link"},
     {"left_knee_link", "left_knee_link"}},
    {"right thigh",
     {"RightUpLeg", "RightUpLeg"},
     {"RightLeg", "RightLeg"},
     {"right_hip_roll_link", "right_hip_roll_link"},
     {"right_knee_link", "right_knee_link"}},
    {"left shin",
     {"LeftLeg", "LeftLeg"},
     {"LeftFoot", "LeftFoot"},
     {"left_knee_link", "left_knee_link"},
     {"left_ankle_pitch_link", "left_ankle_pitch_link"}},
    {"right shin",
     {"RightLeg", "RightLeg"},
     {"RightFoot", "RightFoot"},
     {"right_knee_link", "right_knee_link"},
     {"right_ankle_pitch_link", "right_ankle_pitch_link"}},
    {"left upper arm",
     {"LeftArm", "LeftArm"},
     {"LeftForeArm", "LeftForeArm"},
     {"left_shoulder_roll_link", "left_shoulder_roll_link"},
     {"left_elbow_link", "left_elbow_link"}},
    {"right upper arm",
     {"RightArm", "RightArm"},
     {"RightForeArm", "RightForeArm"},
     {"right_shoulder_roll_link", "right_shoulder_roll_link"},
     {"right_elbow_link", "right_elbow_link"}},
    {"left forearm",
     {"LeftForeArm", "LeftForeArm"},
     {"LeftHand", "LeftHand"},
     {"left_elbow_link", "left_elbow_link"},
     {"left_wrist_yaw_link", "left_wrist_yaw_link"}},
    {"right forearm",
     {"RightForeArm", "RightForeArm"},
     {"RightHand", "RightHand"},
     {"right_elbow_link", "right_elbow_link"},
     {"right_wrist_yaw_link", "right_wrist_yaw_link"}},
    {"trunk",
     {"LeftUpLeg", "RightUpLeg"},
     {"LeftArm", "RightArm"},
     {"left_hip_pitch_link", "right_hip_pitch_link"},
     {"left_shoulder_pitch_link", "right_shoulder_pitch_link"}},
    {"hip line",
     {"RightUpLeg", "RightUpLeg"},
     {"LeftUpLeg", "LeftUpLeg"},
     {"right_hip_pitch_link", "right_hip_pitch_link"},
     {"left_hip_pitch_link", "left_hip_pitch_link"}},
    {"shoulder line",
     {"RightArm", "RightArm"},
     {"LeftArm", "LeftArm"},
     {"right_shoulder_pitch_link", "right_shoulder_pitch_link"},
     {"left_shoulder_pitch_link", "left_shoulder_pitch_link"}},
}};

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

// Mean angle of each segment over the clip, degrees.
using Angles = std::array<double, kSegments.size()>;

double mean(const Angles& angles) {
  double sum = 0.0;
  for (const double angle : angles) sum += angle;
  return sum / static_cast<double>(angles.size());
}

struct Outcome {
  HumanClip human;
  RobotClip robot;
  Angles angles{};
};

class LimbSegments : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto shared = shared_folder();
    if (!shared) GTEST_SKIP() << kNoSharedFolder;
    data_ = *shared / "data";
    const fs::path source(RETARGET_SOURCE_DIR);
    robot_ = load_g1();
    dialects_ = load_skeleton_profiles(source / "configs" / "skeletons").value();
    published_ =
        load_config((source / "configs" / "lafan1_to_unitree_g1.json").string(), *robot_).value();
    derived_ =
        load_config((source / "robots" / "unitree_g1" / "ik.json").string(), *robot_).value();
  }

  Result<Outcome> run(const fs::path& file) {
    std::optional<double> height;
    std::optional<Clip> clip;
    if (file.extension() == ".npz") {
      auto motion = load_smpl(file.string());
      if (!motion) return failure(motion.error());
      height = motion->height;
      clip = std::move(motion->clip);
    } else {
      auto bvh = load_bvh(file.string());
      if (!bvh) return failure(bvh.error());
      clip = std::move(bvh->clip);
    }
    const auto map = recognise_skeleton(*clip, dialects_);
    if (!map) return failure(map.error());
    CalibrationOptions options;
    options.height = height;
    const auto calibration = calibrate(*clip, *map, options);
    if (!calibration) return failure(calibration.error());
    // The first half minute suffices.
    const int frames = std::min(clip->frame_count(), static_cast<int>(30 * clip->rate().fps()));
    const auto at_30 = resample(cut(*clip, 0, frames), FrameRate{30, 1});
    if (!at_30) return failure(at_30.error());
    Outcome outcome;
    outcome.human = to_human(*at_30, *calibration);
    SolveFramesOptions retarget_options;
    if (calibration->rest_pose != "lafan1") {
      retarget_options.scale = ScaleRule::kLimbs;
    }
    const bool is_lafan1 = map->profile.starts_with("lafan1");
    auto result = solve_frames(outcome.human, robot_, is_lafan1 ? published_ : derived_,
                               robot_->model_limits(), retarget_options);
    if (!result) return failure(result.error());
    outcome.robot = std::move(result->clip);
    outcome.angles = angles(outcome.human, outcome.robot);
    return outcome;
  }

  Angles angles(const HumanClip& human, const RobotClip& robot) const {
    Angles sums{};
    std::vector<Pose> world_from_body(robot_->bodies().size());
    for (int frame = 0; frame < human.frame_count; ++frame) {
      forward_kinematics(*robot_, robot.qpos(frame), world_from_body);
      const auto bone = [&](const char* name) -> const Eigen::Vector3d& {
        return human.frame(frame)[bone_from_name(name).value()].translation;
      };
      const auto body = [&](const char* name) -> const Eigen::Vector3d& {
        return world_from_body[robot_->find_body(name).value()].translation;
      };
      for (std::size_t i = 0; i < kSegments.size(); ++i) {
        const Segment& s = kSegments[i];
        const Eigen::Vector3d of_human = bone(s.human_to[0]) + bone(s.human_to[1]) -
                                         bone(s.human_from[0]) - bone(s.human_from[1]);
        const Eigen::Vector3d of_robot = body(s.robot_to[0]) + body(s.robot_to[1]) -
                                         body(s.robot_from[0]) - body(s.robot_from[1]);
        sums[i] += degrees_between(of_human, of_robot) / human.frame_count;
      }
    }
    return sums;
  }

  // Means of files that are no worse than LAFAN1's walking, with some tolerance.
  void expect_near_lafan1(const std::vector<fs::path>& files) {
    const auto walking = value_of(run(data_ / "lafan1" / "walk4_subject1.bvh"));
    std::cout << "walk4_subject1: " << mean(walking.angles) << " degrees\n";
    for (const fs::path& file : files) {
      const auto outcome = value_of(run(file));
      const double found = mean(outcome.angles);
      std::string single;
      for (std::size_t i = 0; i < kSegments.size(); ++i) {
        single += std::string(", ") + kSegments[i].name + " " + std::to_string(outcome.angles[i]);
        // Swapped sides, a mirrored or a lying robot.
        EXPECT_LT(outcome.angles[i], 60.0) << file << ": " << kSegments[i].name;
      }
      std::cout << file.filename().string() << ": " << found << " degrees" << single << "\n";
      EXPECT_LT(found, mean(walking.angles) + 3.0) << file;
    }
  }

  fs::path data_;
  std::vector<SkeletonProfile> dialects_;
  ResolvedConfig published_, derived_;  // of LAFAN1, of all others
  std::shared_ptr<const Robot> robot_;
};

TEST_F(LimbSegments, EveryDialectMatchesLafan1) {
  const std::set<std::string> others = {"nonhuman_dog", "full_precision_frame_time",
                                        "rotation_first_root", "slimevr_hmd_root"};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(data_ / "dialects")) {
    if (entry.path().extension() == ".bvh" && !others.contains(entry.path().stem().string())) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  expect_near_lafan1(files);
}

TEST_F(LimbSegments, SmplMatchesLafan1) {
  expect_near_lafan1({data_ / "smpl" / "smpl_walk.npz", data_ / "smpl" / "smpl_jump_forward.npz"});
}

}  // namespace
}  // namespace retarget
