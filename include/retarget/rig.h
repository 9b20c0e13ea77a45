#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

// Link retarget::rig.
namespace RETARGET_API retarget {

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
/// kConfig errors, one sentence each: what load_robot refuses, closed chains, and what is no humanoid:
/// an arm, a quadruped, wheels.
[[nodiscard]] Result<MadeRobot> make_robot(const std::string& model_path, const std::string& name);

/// Whether a robot of that name can be made from a model and saved `into` a folder, as far as names
/// and places tell. Usage errors: the name is none of a folder, the model lies in the robot's folder.
[[nodiscard]] Result<void> check_new_robot(const std::string& model_path, const std::string& name,
                                           const std::filesystem::path& into);

/// Writes the robot's folder into another one: whole or not at all. Where something of that name is
/// there already, `force` puts the new folder in its place in one step, provided that it is a folder
/// whose robot.json make_robot wrote for a robot of this name; all else of that name stays. Usage
/// errors: something is there and may not be replaced, the name is none of a folder, the folder to
/// write into is not there.
/// @return the folder that was written.
[[nodiscard]] Result<std::filesystem::path> save_robot(const MadeRobot& robot,
                                                       const std::filesystem::path& into,
                                                       bool force);

/// The files of a robot; empty: there is none.
struct RobotSources {
  std::string name;     ///< For lists.
  std::string model;    ///< MJCF.
  std::string profile;  ///< `robot.json`
  std::string mapping;  ///< For sources in LAFAN1's shape, and all where there is no other.
  std::string mapping_of_others;  ///< For all other sources.
};

/// How a description is written: for people, or as JSON with more digits.
enum class TextForm : unsigned char { kPlain, kJson };

/// A robot's heights, joints with limits, and mapping. Both forms may be shown at a terminal.
/// Errors (kConfig): those of load_robot.
[[nodiscard]] Result<std::string> describe_robot(const RobotSources& robot, TextForm form);

/// A line a robot: name, number of joints, height, description, whether its maker states a licence.
[[nodiscard]] Result<std::string> describe_robots(std::span<const RobotSources> robots,
                                                  TextForm form);

/// Something that is wrong or odd about a robot.
struct RobotFinding {
  bool fault = false;  ///< It gives wrong motions or none; else worth knowing.
  std::string text;
};

/// Looks for everything that is wrong or odd about a robot, its profile and its mappings; faults come
/// first.
///
/// Faults: files that cannot be read; bodies and bones of a mapping that do not exist; offsets that
/// leave a limb more than 75 degrees off the T-pose; feet more than a quarter of a leg out of reach; no
/// legs or arms to map to. Notes: offsets more than 8 degrees off, targets slightly out of reach,
/// joints that no task moves, differences between left and right (weights, scales, offsets, ranges),
/// limit sets tighter than the model's ranges, joints without a speed limit, missing soles or T-pose.
/// Errors (kConfig): a model that cannot be loaded.
[[nodiscard]] Result<std::vector<RobotFinding>> check_robot(
    const RobotSources& robot, OptionSpelling spelling = option_as_field);

}  // namespace retarget
