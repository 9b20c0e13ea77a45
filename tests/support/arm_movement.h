#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "formats/bvh/read_bvh.h"
#include "solve/fit/fit.h"
#include "support/lafan1_map.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {

inline Clip sample_clip(const std::string& name) {
  auto clip =
      value_of(load_bvh((std::filesystem::path(RETARGET_SOURCE_DIR) / "data" / name).string()));
  return std::move(clip.clip);
}

// Directions of the upper arms, degrees: elevation from the horizontal, outwards from the front;
// and the elbow flexion, upwards.
struct ArmPose {
  double up, outwards, bend;
};

// Sets the arms of a standing person.
class ArmPoser {
 public:
  explicit ArmPoser(const Clip& clip) : skeleton_(clip.skeleton()) {
    left_ = clip.rotations(0)[0] * Eigen::Vector3d::UnitZ();
    left_.y() = 0.0;
    left_.normalize();
    front_ = left_.cross(Eigen::Vector3d::UnitY());
  }

  void pose(std::span<Eigen::Quaterniond> rotations, const ArmPose& arms) const {
    for (const std::string side : {"Left", "Right"}) {
      const Eigen::Vector3d outwards = side == "Left" ? left_ : Eigen::Vector3d(-left_);
      const double up = radians(arms.up), out = radians(arms.outwards), bend = radians(arms.bend);
      const Eigen::Vector3d level = std::cos(out) * front_ + std::sin(out) * outwards;
      const Eigen::Vector3d upper = std::sin(up) * Eigen::Vector3d::UnitY() + std::cos(up) * level;
      const Eigen::Vector3d bent = std::cos(up) * Eigen::Vector3d::UnitY() - std::sin(up) * level;
      const Eigen::Vector3d lower = std::cos(bend) * upper + std::sin(bend) * bent;
      const Eigen::Vector3d hinge = -upper.cross(lower).normalized();
      turn(rotations, side + "Arm", along(upper, hinge));
      turn(rotations, side + "ForeArm", along(lower, hinge));
      rotations[joint(side + "Hand")] = Eigen::Quaterniond::Identity();
    }
  }

 private:
  static double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }
  static Eigen::Quaterniond along(const Eigen::Vector3d& x, const Eigen::Vector3d& z) {
    Eigen::Matrix3d axes;
    axes << x, z.cross(x), z;
    return Eigen::Quaterniond(axes);
  }
  [[nodiscard]] std::size_t joint(const std::string& name) const {
    return static_cast<std::size_t>(skeleton_.find(name).value());
  }
  void turn(std::span<Eigen::Quaterniond> rotations, const std::string& name,
            const Eigen::Quaterniond& world_from_bone) const {
    const std::size_t own = joint(name);
    Eigen::Quaterniond world_from_parent = Eigen::Quaterniond::Identity();
    for (int j = skeleton_.joint(static_cast<int>(own)).parent; j >= 0;
         j = skeleton_.joint(j).parent) {
      world_from_parent = rotations[static_cast<std::size_t>(j)] * world_from_parent;
    }
    rotations[own] = (world_from_parent.conjugate() * world_from_bone).normalized();
  }

  const Skeleton& skeleton_;
  Eigen::Vector3d left_, front_;
};

// A standing person moves both arms from pose to pose.
inline Clip arm_movement(std::span<const ArmPose> poses, int frames_per_pose = 30,
                         const FrameRate& rate = {30, 1}) {
  const Clip standing = cut(sample_clip("wave.bvh"), 0, 1);
  const ArmPoser poser(standing);
  Clip clip(standing.shared_skeleton(), rate,
            frames_per_pose * static_cast<int>(poses.size() - 1) + 1);
  for (int t = 0; t < clip.frame_count(); ++t) {
    std::ranges::copy(standing.rotations(0), clip.rotations(t).begin());
    std::ranges::copy(standing.translations(0), clip.translations(t).begin());
    const auto from = std::min(static_cast<std::size_t>(t / frames_per_pose), poses.size() - 2);
    const double share = static_cast<double>(t) / frames_per_pose - static_cast<double>(from);
    const double s = share * share * (3.0 - 2.0 * share);
    const ArmPose &a = poses[from], &b = poses[from + 1];
    poser.pose(clip.rotations(t),
               {a.up + s * (b.up - a.up), a.outwards + s * (b.outwards - a.outwards),
                a.bend + s * (b.bend - a.bend)});
  }
  return clip;
}

struct RobotCase {
  std::shared_ptr<const Robot> robot;
  ResolvedConfig config;
};

inline RobotCase robot_case(const std::string& name) {
  const auto folder = std::filesystem::path(RETARGET_SOURCE_DIR) / "robots" / name;
  const auto robot = load_robot_in(folder);
  const auto config = value_of(load_config((folder / "ik.json").string(), *robot));
  return {robot, config};
}

inline Result<FitResult> fitted(const Clip& clip, const RobotCase& robot,
                                const FitOptions& options = {}, const FitRun& given = {}) {
  FitRun run = given;
  run.retarget.scale = ScaleRule::kLimbs;
  return fit(clip, lafan1_calibration(clip.skeleton()), robot.robot, robot.config,
             robot.robot->model_limits(), options, run);
}

// The fit without recovery.
inline Result<FitResult> plainly_fitted(const Clip& clip, const RobotCase& robot,
                                        const FitOptions& options = {}, FitRun run = {}) {
  run.recover_limbs = false;
  return fitted(clip, robot, options, run);
}

inline bool same(const RobotClip& a, const RobotClip& b, int frame) {
  return std::ranges::equal(a.qpos(frame), b.qpos(frame));
}

}  // namespace retarget
