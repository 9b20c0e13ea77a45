// Derived configurations compared with the published ones, and the configurations of every included
// robot.

#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
#include <map>

#include "formats/bvh/read_bvh.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/recognise.h"
#include "limb_errors.h"
#include "retarget/file.h"
#include "retarget/load_robot.h"
#include "retarget/resample.h"
#include "retarget/robots.h"
#include "robot/anatomy/shapes.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/targets/solve_frames.h"
#include "support/angles.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

fs::path source_folder() {
  return fs::path(RETARGET_SOURCE_DIR);
}

std::shared_ptr<const Robot> shipped(const std::string& name) {
  const auto files = find_robot(name, {source_folder() / "robots"}).value();
  return load_robot_files(files.model.string(), files.profile.string()).value();
}

fs::path mapping_of(const std::string& name) {
  return find_robot(name, {source_folder() / "robots"})->model.parent_path() / "ik.json";
}

// Three seconds of a clip, fifteen frames each.
HumanClip walking(const fs::path& file) {
  const auto profiles = load_skeleton_profiles(source_folder() / "configs" / "skeletons").value();
  const auto bvh = load_bvh(file.string()).value();
  const auto map = recognise_skeleton(bvh.clip, profiles).value();
  const auto calibration = calibrate(bvh.clip, map, {}).value();
  const int begin = std::min(bvh.clip.frame_count() / 4, static_cast<int>(bvh.clip.rate().fps()));
  const int end =
      std::min(bvh.clip.frame_count(), begin + static_cast<int>(3.0 * bvh.clip.rate().fps()));
  return to_human(resample(cut(bvh.clip, begin, end), FrameRate{15, 1}).value(), calibration);
}

double error_degrees(const HumanClip& human, const std::shared_ptr<const Robot>& robot,
                     const RobotAnatomy& limbs, const RetargetingConfig& config) {
  const auto result = value_of(solve_frames(human, robot, resolve_config(config, *robot).value(),
                                            robot->model_limits(), {}));
  const auto errors = limb_errors(human, result.clip, limbs);
  for (const LimbError& error : errors) {
    // Swapped sides, a mirrored or a lying robot.
    EXPECT_LT(error.mean * kDegrees, 60.0) << robot->name() << ": " << error.segment;
  }
  return mean_limb_error(errors) * kDegrees;
}

RetargetingConfig derived(const Robot& robot, const RobotAnatomy& limbs) {
  DeriveOptions options;
  options.sole_height = find_shapes(robot, limbs, {}).ankle_height;
  return derive_config(robot, limbs, options);
}

void expect_derived_no_worse(const HumanClip& human) {
  for (const std::string name :
       {"unitree_g1", "booster_t1_29dof", "fourier_n1", "stanford_toddy", "engineai_pm01"}) {
    const auto robot = shipped(name);
    const auto limbs = value_of(find_limbs(*robot, name));
    const fs::path config = source_folder() / "configs" / ("lafan1_to_" + name + ".json");
    const auto published = value_of(load_retargeting_config(config.string()));
    const double theirs = error_degrees(human, robot, limbs, published);
    const double ours = error_degrees(human, robot, limbs, derived(*robot, limbs));
    std::cout << name << ": limbs " << theirs << " degrees off with the published configuration, "
              << ours << " with the derived one\n";
    EXPECT_LT(ours, theirs + 0.5) << name;
  }
}

TEST(DerivedConfig, IsAtLeastAsGoodAsPublishedOnSampleWalk) {
  expect_derived_no_worse(walking(source_folder() / "data" / "walk.bvh"));
}

TEST(DerivedConfig, IsAtLeastAsGoodAsPublishedOnLafan1Walk) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  expect_derived_no_worse(walking(*shared / "data" / "lafan1" / "walk4_subject1.bvh"));
}

// The first frame is solved from the zero configuration for any facing of the human: an arm left
// behind would never recover.
TEST(DerivedConfig, LimbsFollowFromTheZeroConfiguration) {
  const HumanClip walk = walking(source_folder() / "data" / "walk.bvh");
  for (const std::string name : {"unitree_g1", "booster_t1_29dof", "fourier_n1"}) {
    const auto robot = shipped(name);
    const auto limbs = value_of(find_limbs(*robot, name));
    const RetargetingConfig config = derived(*robot, limbs);
    for (int heading = 0; heading < 360; heading += 30) {
      HumanClip turned = walk;
      const Pose turn{
          Eigen::Quaterniond(Eigen::AngleAxisd(heading / kDegrees, Eigen::Vector3d::UnitZ())),
          Eigen::Vector3d::Zero()};
      for (HumanPose& frame : turned.world_from_bone) {
        for (Pose& world_from_bone : frame) world_from_bone = turn * world_from_bone;
      }
      EXPECT_LT(error_degrees(turned, robot, limbs, config), 5.0) << name << ", " << heading;
    }
  }
}

// Offsets of rows with equal body and bone, as angles between the rotations.
TEST(DerivedConfig, MatchesPublishedOffsets) {
  // The elbow chains of T1 and N1 are plain; the G1's thigh frames are 10 degrees oblique.
  const std::map<std::string, double> tolerance = {{"unitree_g1", 11.0},
                                                   {"booster_t1_29dof", 4.0},
                                                   {"fourier_n1", 1.0},
                                                   {"engineai_pm01", 12.0}};
  for (const auto& [name, degrees] : tolerance) {
    const auto robot = shipped(name);
    const auto limbs = value_of(find_limbs(*robot, name));
    const RetargetingConfig ours = derived(*robot, limbs);
    const auto published = value_of(load_retargeting_config(
        (source_folder() / "configs" / ("lafan1_to_" + name + ".json")).string()));
    int compared = 0;
    for (const IkMatch& theirs : published.match_tables[0].rows) {
      for (const IkMatch& row : ours.match_tables[0].rows) {
        if (row.body != theirs.body || row.bone != theirs.bone) continue;
        ++compared;
        const Eigen::Quaterniond apart = row.rotation_offset.conjugate() * theirs.rotation_offset;
        const double angle = 2.0 * std::atan2(apart.vec().norm(), std::abs(apart.w())) * kDegrees;
        EXPECT_LT(angle, degrees) << name << ": " << row.body;
      }
    }
    EXPECT_GE(compared, 7) << name;
  }
}

TEST(ShippedRobots, WalkWithTheirOwnMappings) {
  const HumanClip human = walking(source_folder() / "data" / "walk.bvh");
  for (const std::string& name : list_robots({source_folder() / "robots"})) {
    const fs::path file = mapping_of(name);
    const auto robot = shipped(name);
    const auto limbs = value_of(find_limbs(*robot, name));
    const auto config = value_of(load_retargeting_config(file.string()));
    const double error = error_degrees(human, robot, limbs, config);
    std::cout << name << ": limbs " << error << " degrees off\n";
    EXPECT_LT(error, 5.0) << name;
  }
}

TEST(ShippedRobots, MappingsMatchTheDerivedOnes) {
  for (const std::string& name : list_robots({source_folder() / "robots"})) {
    const auto robot = shipped(name);
    const auto limbs = value_of(find_limbs(*robot, name));
    const auto file = value_of(read_file(mapping_of(name).string()));
    EXPECT_EQ(std::string(file.view()), format_retargeting_config(derived(*robot, limbs)))
        << name << ": retarget robots add " << name << " makes the file anew";
  }
}

TEST(ShippedRobots, TPoseOfTheProfileIsATPose) {
  for (const std::string& name : list_robots({source_folder() / "robots"})) {
    const auto robot = shipped(name);
    const auto limbs = value_of(find_limbs(*robot, name));
    std::vector<double> qpos = robot->zero_configuration();
    for (const RobotJoint& joint : robot->joints()) {
      const auto found = robot->profile().t_pose.find(joint.name);
      qpos[static_cast<std::size_t>(joint.qpos_address)] =
          found == robot->profile().t_pose.end() ? 0.0 : found->second;
    }
    std::vector<Pose> world_from_body(robot->bodies().size());
    forward_kinematics(*robot, qpos, world_from_body);
    const auto at = [&](const LimbPart& part) -> Eigen::Vector3d {
      return world_from_body[static_cast<std::size_t>(part.body)] * part.joint;
    };
    for (std::size_t side = 0; side < 2; ++side) {
      const Eigen::Vector3d outwards = side == 0 ? limbs.left : Eigen::Vector3d(-limbs.left);
      const auto along = [](const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                            const Eigen::Vector3d& direction) {
        return (to - from).normalized().dot(direction);
      };
      const Limb& leg = limbs.legs[side];
      const Limb& arm = limbs.arms[side];
      EXPECT_GT(along(at(leg.upper), at(*leg.end), -Eigen::Vector3d::UnitZ()), 0.99) << name;
      EXPECT_GT(along(at(arm.upper), at(arm.lower), outwards), 0.97) << name;
      if (arm.end) {
        EXPECT_GT(along(at(arm.upper), at(*arm.end), outwards), 0.99) << name;
      }
    }
  }
}

}  // namespace
}  // namespace retarget
