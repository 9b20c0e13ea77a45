#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A robot's folder before it is written, and what is worth a look.
struct MadeRobot {
  std::string name;
  std::string model;                 ///< `model.xml`: MJCF without meshes.
  std::string profile;               ///< `robot.json`.
  std::string mapping;               ///< `ik.json`: from the canonical human.
  std::string decisions;             ///< `decisions.md`: what was decided and how sure it is.
  std::vector<std::string> notes;    ///< What to look at, one line each.
  std::vector<std::string> summary;  ///< What was found, one line each: limbs, T-pose, scales.
};

/// Makes a robot's folder from a model: MJCF, or URDF as MuJoCo reads it. Meshes need not be there
/// (package:// paths do not matter). A model without a free joint gets one.
///
/// kConfig errors, one sentence each: what load_robot refuses, closed chains, and what find_limbs
/// refuses: an arm, a quadruped, wheels.
[[nodiscard]] Result<MadeRobot> make_robot(const std::string& model_path, const std::string& name);

/// Writes the robot's folder into another one: whole or not at all. Where something of that name is
/// there already, `force` puts the new folder in its place in one step, provided that it is a folder
/// whose robot.json make_robot wrote for a robot of this name; all else of that name stays. Usage
/// errors: something is there and may not be replaced, the name is none of a folder, the folder to
/// write into is not there.
/// @return the folder that was written.
[[nodiscard]] Result<std::filesystem::path> save_robot(const MadeRobot& robot,
                                                       const std::filesystem::path& into,
                                                       bool force);

}  // namespace retarget
