#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "console.h"
#include "human_source.h"
#include "options.h"
#include "pipeline/targets.h"
#include "retarget/clip.h"
#include "retarget/ik_config.h"
#include "retarget/robot.h"

namespace retarget::cli {

/// The motion as it is solved.
struct Source {
  Clip clip;        ///< Cut and at the output rate.
  int lead_in = 0;  ///< Source frames in front that were left out.
  HumanSource human;
};

/// A robot and the model file that it came from.
struct ChosenRobot {
  std::shared_ptr<const Robot> robot;
  std::string model;
};

/// The folder that holds robots/ and configs/.
[[nodiscard]] Result<std::filesystem::path> data_folder_of(const CommonOptions& options);

/// Makes the file of --smpl the source; --bvh beside it is refused.
[[nodiscard]] Result<void> choose_motion_file(RunOptions& options);

/// The motion file and the human in it; says what was found.
[[nodiscard]] Result<Source> load_source(const RunOptions& options,
                                         const std::filesystem::path& data_folder,
                                         Console& console);

/// Puts the whole name of a robot in the place of a short one, for what is kept of a run.
[[nodiscard]] Result<void> resolve_robot(std::string& robot,
                                         const std::filesystem::path& data_folder);

/// One robot, by --robot or --robot-xml; else a kUsage error.
[[nodiscard]] Result<void> check_robot_choice(const RunOptions& options);

/// Whether a robot without soles is given some, which is said: where motions are made or measured.
enum class Soles : unsigned char { kAsTheyAre, kNeeded };

/// The robot that --robot or --robot-xml names.
[[nodiscard]] Result<ChosenRobot> load_chosen_robot(const RunOptions& options,
                                                    const std::filesystem::path& data_folder,
                                                    Console& console,
                                                    Soles soles = Soles::kAsTheyAre);

/// The mappings of a robot, loaded.
struct RobotMappings {
  ResolvedMapping of_lafan1;                 ///< For sources in LAFAN1's shape.
  std::optional<ResolvedMapping> of_others;  ///< For all other sources; nothing: the same.

  /// The one for a source: LAFAN1's shape is that of its two releases.
  [[nodiscard]] const ResolvedMapping& for_source(const HumanSource& human) const;
};

/// The mappings that --ik-config chooses, or the robot's own (find_mappings), checked.
[[nodiscard]] Result<RobotMappings> load_mappings(const RunOptions& options,
                                                  const ChosenRobot& robot,
                                                  const std::filesystem::path& data_folder);

/// How the body's size scales the motion: as --scale says, else as is best for the source.
[[nodiscard]] HeightScale choose_scale(const HumanSource& human, const Robot& robot,
                                       const ResolvedMapping& tables, const RunOptions& options);

/// The rate that --fps names; nothing: the source's own.
[[nodiscard]] Result<std::optional<FrameRate>> output_rate(const std::string& text);

}  // namespace retarget::cli
