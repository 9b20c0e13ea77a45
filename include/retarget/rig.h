#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"

// Link retarget::rig.
namespace RETARGET_API retarget {

/// A robot's folder before it is written, and notes about it.
struct MadeRobot {
  std::string name;
  std::string model;                 ///< `model.xml`: MJCF without meshes.
  std::string profile;               ///< `robot.json`.
  std::string config;                ///< `ik.json`: from the canonical human.
  std::string decisions;             ///< `decisions.md`: the decisions and how certain they are.
  std::vector<std::string> notes;    ///< What to check, one line each.
  std::vector<std::string> summary;  ///< What was detected, one line each: limbs, T-pose, scales.
};

/// Makes a robot's folder from a model: MJCF, or URDF as MuJoCo reads it. Meshes are not needed
/// (package:// paths do not matter). A model without a free joint gets one, in the place of slides
/// at its root as well.
///
/// kConfig errors, one sentence each: what load_robot rejects, closed chains, lengths and ranges in
/// other units, limbs without knee or elbow, a T-pose that cannot be reached, and robots that are
/// not humanoid: an arm, a quadruped, wheels.
/// @param base  kFixed: an upper body, whose base stands fast; only its arms must be there.
[[nodiscard]] Result<MadeRobot> make_robot(const std::string& model_path, const std::string& name,
                                           RobotBase base = RobotBase::kAuto);

/// Whether a robot of this name can be made from a model and saved `into` a folder, judging by
/// names and paths. Usage errors: the name is not a valid folder name, the model is inside the
/// robot's folder.
[[nodiscard]] Result<void> check_new_robot(const std::string& model_path, const std::string& name,
                                           const std::filesystem::path& into);

/// Writes the robot's folder into another one: completely or not at all. If the name already
/// exists, `force` replaces it atomically, provided that it is a folder whose robot.json make_robot
/// wrote for a robot of this name; anything else is kept. Usage errors: the name exists and may not
/// be replaced, it is not a valid folder name, the folder to write into does not exist.
/// @return the written folder.
[[nodiscard]] Result<std::filesystem::path> save_robot(const MadeRobot& robot,
                                                       const std::filesystem::path& into,
                                                       bool force);

/// The files of a robot; empty: none.
struct RobotSources {
  std::string name;     ///< For lists.
  std::string model;    ///< MJCF.
  std::string profile;  ///< `robot.json`
  std::string config;   ///< For sources in the form of LAFAN1, and for all if there is no other.
  std::string config_of_others;  ///< For all other sources.
  RobotBase base = RobotBase::kAuto;
};

/// Form of a description: human-readable, or JSON with more digits.
enum class TextForm : unsigned char { kPlain, kJson };

/// A robot's heights, joints with limits, and configuration. Both forms are safe to print to a terminal.
/// Errors (kConfig): those of load_robot.
[[nodiscard]] Result<std::string> describe_robot(const RobotSources& robot, TextForm form);

/// A line a robot: name, number of joints, height, description, whether its maker states a licence.
[[nodiscard]] Result<std::string> describe_robots(std::span<const RobotSources> robots,
                                                  TextForm form);

/// Something wrong or odd about a robot.
struct RobotFinding {
  bool fault = false;  ///< An error: motions are wrong or impossible; else a note.
  std::string text;
};

/// Lists everything wrong or odd about a robot, its profile and its configurations; errors come first.
///
/// Errors: files that cannot be read; bodies and bones of a retargeting configuration that do not
/// exist; offsets that leave a limb more than 75 degrees off the T-pose; feet more than a quarter
/// of a leg out of reach; no legs or arms to map to; what make_robot rejects. A model without profile
/// and configuration is read as make_robot reads it. Notes: joints without a range, offsets more than 8 degrees off,
/// targets slightly out of reach, joints that no task moves, differences between left and right
/// (weights, scales, offsets, ranges), limit sets tighter than the model's ranges, joints without a
/// speed limit, missing soles or T-pose.
/// Errors (kConfig): a model that cannot be loaded.
[[nodiscard]] Result<std::vector<RobotFinding>> check_robot(
    const RobotSources& robot, OptionSpelling spelling = option_as_field);

}  // namespace retarget
