#pragma once

#include <memory>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// A line of a summary for people: a short label, then what there is to say. A line without a label
/// goes on with what the line before is about. Options in texts are marked (spell_options).
struct SummaryLine {
  std::string label, text;
};

/// The folder that holds robots/ and configs/ where nobody names one: of an installed library, as
/// find_package(retarget) told the program.
inline const char* installed_data_folder() {
#ifdef RETARGET_INSTALLED_DATA_FOLDER
  return RETARGET_INSTALLED_DATA_FOLDER;
#else
  return "";
#endif
}

/// Where robots/ and configs/ are.
struct DataFolder {
  std::string chosen;  ///< By the user; empty: $RETARGET_DATA_DIR, else found.
  std::string installed = installed_data_folder();
};

/// Reads a motion file; what kind it is, its content says: BVH, or an NPZ of SMPL or SMPL-X.
///
/// Errors (kInput): the file's faults with line and column; more than `memory_gb` needs.
/// @param file  `-` reads standard input.
/// @return the motion in the file's units and axes; its origin() has the reader's warnings.
[[nodiscard]] Result<Clip> load_clip(const std::string& file, const SourceOptions& options = {});

/// The same of a skeleton, which need not have frames.
[[nodiscard]] Result<Clip> load_skeleton(const std::string& file,
                                         const SourceOptions& options = {});

/// A robot and where it came from.
struct LoadedRobot {
  std::shared_ptr<const Robot> robot;
  RobotChoice choice;              ///< What was asked for; its name is the whole one.
  std::string name;                ///< What names it: the whole name where a short one was given.
  std::string model;               ///< Its MJCF or URDF,
  std::string profile;             ///< and its robot.json; empty: none.
  std::string data_folder;         ///< With robots/ and configs/.
  std::vector<SummaryLine> notes;  ///< What was found for it: soles.
  std::vector<Warning> warnings;   ///< What is odd about its model.
};

/// Whether a robot without soles is given some, found in its model.
enum class Soles : unsigned char { kFound, kAsTheyAre };

/// Loads a robot by its name, folder or model.
///
/// A motion whose feet nobody knows floats or sinks: of a robot without soles they are looked for in
/// its model, which a note tells, or a warning why they were not found.
/// Errors (kConfig): an unknown robot suggests the nearest; faults of its files.
[[nodiscard]] Result<LoadedRobot> load_robot(const RobotChoice& choice,
                                             const DataFolder& data_folder = {},
                                             Soles soles = Soles::kFound);

/// The same by name or folder, or by a model file (.xml, .urdf).
[[nodiscard]] Result<LoadedRobot> load_robot(const std::string& name_or_file);

}  // namespace retarget
