#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// Which bones a clip has, and how they become the canonical human.
struct HumanInClip {
  BoneMap map;
  Calibration calibration;

  /// What was recognised, line by line.
  [[nodiscard]] std::vector<SummaryLine> lines() const;
  /// Why the recognition may be wrong.
  [[nodiscard]] const std::vector<Warning>& doubts() const { return calibration.doubts; }
  /// Bones without a place.
  [[nodiscard]] std::vector<Bone> missing_bones() const;
  /// Whether it has the form of LAFAN1, for which the published configurations are made.
  [[nodiscard]] bool is_lafan1() const;
};

/// What is decided for a robot independently of the clip: loaded once for many clips.
struct RobotSetup {
  LoadedRobot loaded;
  LimitSet limits;
  ResolvedConfig config;  ///< For clips in the form of LAFAN1, and for all if there is no other.
  std::optional<ResolvedConfig> config_of_others;
  FitOptions fit;            ///< Of Method::kFit, with the options file read and terms removed.
  FitOptions fit_of_robots;  ///< The same for robots' motions, whose rotations are known.

  [[nodiscard]] const ResolvedConfig& config_for(const HumanInClip& human) const;
};

/// How a clip becomes a robot's motion: every decision, made once and written down. A plain value:
/// every member may be read and replaced before solve().
struct Plan {
  std::shared_ptr<const Clip> clip;  ///< As it was read; null after solve(Plan&&).
  LoadedRobot robot;
  Options options;  ///< As given; the members below take precedence.

  HumanInClip human;

  FrameRange part;         ///< Frames of the clip that are used.
  int lead_in_frames = 0;  ///< Dropped leading frames that are not part of the motion.
  FrameRate rate;          ///< Of the motion.

  LimitSet limits;
  ResolvedConfig config;
  bool is_config_of_others = false;  ///< Chosen because the clip is not in the form of LAFAN1.
  ScaleRule scale = ScaleRule::kLimbs;
  FitOptions fit;
  std::vector<SummaryLine> clip_notes;    ///< What was left out of the clip, and why.
  std::vector<SummaryLine> config_notes;  ///< The same of the configuration.

  /// The robot and how it follows the clip, line by line.
  [[nodiscard]] std::vector<SummaryLine> robot_lines() const;
  /// All decisions as text, one line each.
  [[nodiscard]] std::string summary() const;
  /// Frames of the motion that solve() makes.
  [[nodiscard]] std::int64_t frame_count() const;
};

/// The human in a clip. If a clip's rotations do not match its positions, they are replaced.
/// @param data_folder  with configs/skeletons.
[[nodiscard]] Result<HumanInClip> find_human(Clip& clip, const HumanOptions& options,
                                             const std::string& data_folder);

/// Checks for contradictory options (kUsage), and for values and files that are wrong whatever the
/// clip.
[[nodiscard]] Result<void> check_options(const Options& options);

/// Resolves options for a robot: limits, configurations, the fit's options.
[[nodiscard]] Result<RobotSetup> set_up_robot(LoadedRobot robot, const Options& options);

/// Decides how a clip becomes a robot's motion.
///
/// Errors: of kUsage, options that contradict each other; of kInput, a clip without frames, no
/// human in it, a part outside the clip, more memory than allowed; of kConfig, bad option files.
[[nodiscard]] Result<Plan> make_plan(Clip clip, const RobotSetup& robot, const Options& options);
[[nodiscard]] Result<Plan> make_plan(Clip clip, const LoadedRobot& robot,
                                     const Options& options = {});

/// A plan as JSON: its run, and the value of every decision. The same plan gives the same text.
/// @pre the plan has its clip
[[nodiscard]] std::string plan_json(const Plan& plan);

/// Reads such a file, its clip and its robot. Decisions are taken from the file and not made again,
/// so they can be changed in the file.
/// Errors (kConfig): all errors in the file at once; those of load_clip and load_robot.
[[nodiscard]] Result<Plan> load_plan(const std::string& file, const DataFolder& data_folder = {});

}  // namespace retarget
