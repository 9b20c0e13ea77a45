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

/// The default folder with robots/ and configs/: that of the installed library, as given by
/// find_package(retarget).
inline const char* installed_data_folder() {
#ifdef RETARGET_INSTALLED_DATA_FOLDER
  return RETARGET_INSTALLED_DATA_FOLDER;
#else
  return "";
#endif
}

/// Where robots/ and configs/ are.
struct DataFolder {
  std::string chosen;  ///< By the user; empty: $RETARGET_DATA_DIR, else searched for.
  std::string installed = installed_data_folder();
};

/// Reads a motion file, by its content: BVH; SMPL or SMPL-X as NPZ, as a file of PyTorch, as a
/// pickle or as a single array (docs/smpl.md); places of joints in such files (docs/positions.md); FBX, glTF, VRM and MVNX (docs/scenes.md).
///
/// With SourceOptions::from_robot a robot's motion, in any format of docs/formats.md, as the
/// canonical human that moves so (docs/robot_to_robot.md).
///
/// Errors (kInput): errors in the file with line and column; a clip that needs more than
/// `memory_gb`. kConfig: an unknown robot.
/// @param file         `-` reads standard input.
/// @param data_folder  with robots/, for from_robot.
/// @return the motion in the file's units and axes; its origin() has the reader's warnings.
[[nodiscard]] Result<Clip> load_clip(const std::string& file, const SourceOptions& options = {},
                                     const DataFolder& data_folder = {});

/// The same for a skeleton, which need not have frames.
[[nodiscard]] Result<Clip> load_skeleton(const std::string& file,
                                         const SourceOptions& options = {});

/// A robot and where it came from.
struct LoadedRobot {
  std::shared_ptr<const Robot> robot;
  RobotChoice choice;              ///< What was asked for, with the full name.
  std::string name;                ///< Its full name, also where a short one was given.
  std::string model;               ///< Its MJCF or URDF,
  std::string profile;             ///< and its robot.json; empty: none.
  std::string data_folder;         ///< With robots/ and configs/.
  std::vector<SummaryLine> notes;  ///< What was detected for it: soles.
  std::vector<Warning> warnings;   ///< What is odd about its model.
};

/// Whether missing soles of a robot are derived from its model.
enum class Soles : unsigned char { kFound, kAsTheyAre };

/// Loads a robot by its name, folder or model.
///
/// Without soles the feet would float or sink: they are searched for in the robot's model. A note
/// tells what was found, or a warning why nothing was. Errors (kConfig): an unknown robot (suggests
/// the nearest name); errors in its files.
[[nodiscard]] Result<LoadedRobot> load_robot(const RobotChoice& choice,
                                             const DataFolder& data_folder = {},
                                             Soles soles = Soles::kFound);

/// The same by name or folder, or by a model file (.xml, .urdf).
[[nodiscard]] Result<LoadedRobot> load_robot(const std::string& name_or_file);

/// The motion of a robot as a clip, which retargets like any other: the canonical human that stands
/// as the robot does, whose bones turn as its bodies and are as long, its soles' heels and toes for
/// contacts. In metres, Z up; the zero pose is the T-pose.
/// Errors (kConfig): no retargeting configuration beside the robot's model, or no limbs by it.
[[nodiscard]] Result<Clip> clip_of_robot(const RobotClip& motion, const LoadedRobot& robot,
                                         const std::string& name = {});

}  // namespace retarget
