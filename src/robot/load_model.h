#pragma once

#include <string>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/robot/robot.h"

namespace retarget {

/// A compiled model and what MuJoCo found odd in it.
struct LoadedModel {
  ModelPtr model;
  std::vector<std::string> warnings;
};

/// Compiles an MJCF file without its meshes and other assets, for kinematics.
///
/// Nothing is printed. Models of any kind are taken; a number that is not finite and a range
/// whose lower end is above the upper are errors.
/// Safe to call from several threads, which wait for each other.
[[nodiscard]] Result<LoadedModel> load_model(const std::string& path);

/// Checks that a model is a robot that can move about: one free joint, its first, and else hinges
/// and slides.
[[nodiscard]] Result<void> check_robot_joints(const mjModel_& model, const std::string& path);

}  // namespace retarget
