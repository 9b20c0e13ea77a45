#pragma once

#include <memory>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// A line of a human-readable summary: a short label, then text. A line without a label continues
/// the previous one. Options in texts are marked (spell_options).
struct SummaryLine {
  std::string label, text;
};

/// The data folder (robots/ and configs/) of the installed library; empty: unknown. It comes from
/// find_package(retarget) or, in a shared build, from the location of the library. A program that
/// links the static library without that package may define
/// `extern "C" const char* retarget_package_data_folder()`.
[[nodiscard]] std::string installed_data_folder();

/// Location of the data folder with robots/ and configs/.
struct DataFolder {
  std::string chosen;  ///< The user's choice; empty: $RETARGET_DATA_DIR, else searched for.
};

/// Finds the data folder. The search (find_data_folder of data_folder.h) includes
/// installed_data_folder(). Errors are of kind kConfig.
[[nodiscard]] Result<std::string> find_data_folder(const DataFolder& folder);

/// Reads a motion file; the format is detected by content: BVH; SMPL or SMPL-X as NPZ, PyTorch
/// file, pickle or single array (docs/smpl.md); joint positions in such files (docs/positions.md);
/// FBX, glTF, VRM and MVNX (docs/scenes.md).
///
/// With SourceOptions::from_robot, reads a robot's motion in any format of docs/formats.md and
/// converts it to the canonical human with the same motion (docs/robot_to_robot.md).
///
/// Errors: errors in the file with line and column, a clip that needs more than `memory_gb`
/// (kInput); an unknown robot (kConfig).
/// @param file         `-` reads standard input.
/// @param data_folder  data folder with robots/, for from_robot.
/// @return the motion in the file's units and axes; its origin() has the reader's warnings.
[[nodiscard]] Result<Clip> load_clip(const std::string& file, const SourceOptions& options = {},
                                     const DataFolder& data_folder = {});

/// Reads a skeleton like load_clip; the file need not have frames.
[[nodiscard]] Result<Clip> load_skeleton(const std::string& file,
                                         const SourceOptions& options = {});

/// A robot and its files.
struct LoadedRobot {
  std::shared_ptr<const Robot> robot;
  RobotChoice choice;              ///< The requested robot, with the full name.
  std::string name;                ///< Full name, even if the request used a short one.
  std::string model;               ///< MJCF or URDF file.
  std::string profile;             ///< robot.json file; empty: none.
  std::string data_folder;         ///< Data folder with robots/ and configs/.
  std::vector<SummaryLine> notes;  ///< Detected properties, such as soles.
  std::vector<Warning> warnings;   ///< Warnings about the model.
};

/// Whether missing soles of a robot are derived from its model.
enum class Soles : unsigned char { kFound, kAsTheyAre };

/// Loads a robot by its name, folder or model.
///
/// Without soles the feet would float or sink, so missing soles are derived from the robot's model.
/// A note describes the soles found, or a warning explains why none were found. Errors (kConfig): an
/// unknown robot (suggests the nearest name); errors in its files.
[[nodiscard]] Result<LoadedRobot> load_robot(const RobotChoice& choice,
                                             const DataFolder& data_folder = {},
                                             Soles soles = Soles::kFound);

/// Loads a robot by name or folder, or from a model file (.xml, .urdf).
[[nodiscard]] Result<LoadedRobot> load_robot(const std::string& name_or_file);

/// Converts the motion of a robot to a clip that can be retargeted like any other. The clip is a
/// canonical human with the robot's stance, limb lengths and body rotations; the heels and toes of
/// the robot's soles give the contacts. Metres, Z up; the zero pose is the T-pose.
/// Errors (kConfig): no retargeting configuration next to the robot's model, or one without limbs.
[[nodiscard]] Result<Clip> clip_of_robot(const RobotClip& motion, const LoadedRobot& robot,
                                         const std::string& name = {});

}  // namespace retarget
