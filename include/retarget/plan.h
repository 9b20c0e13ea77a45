#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/contact_edits.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/scene.h"
#include "retarget/time_scale.h"

namespace RETARGET_API retarget {

/// Bone map and calibration of the human in a clip.
struct HumanInClip {
  BoneMap map;
  Calibration calibration;

  /// Recognition results as summary lines.
  [[nodiscard]] std::vector<SummaryLine> lines() const;
  /// Reasons why the recognition may be wrong.
  [[nodiscard]] const std::vector<Warning>& doubts() const { return calibration.doubts; }
  /// Bones without a position in the source.
  [[nodiscard]] std::vector<Bone> missing_bones() const;
  /// Whether the skeleton is a LAFAN1 skeleton, for which the published configurations are made.
  [[nodiscard]] bool is_lafan1() const;
};

/// Decisions for a robot that do not depend on the clip. Load it once for many clips.
struct RobotSetup {
  LoadedRobot loaded;
  LimitSet limits;
  ResolvedConfig config;  ///< Used for LAFAN1 clips, and for all clips without `config_of_others`.
  std::optional<ResolvedConfig> config_of_others;  ///< Used for all other clips.
  FitOptions fit;               ///< Options of Method::kFit after the options file and `without`.
  FitOptions fit_of_robots;     ///< Like `fit`, for robot motions, whose rotations are known.
  std::vector<Warning> doubts;  ///< Reasons why a configuration may not be the robot's.

  [[nodiscard]] const ResolvedConfig& config_for(const HumanInClip& human) const;
  /// Summary lines about the owners of the joints if only the arms follow (RobotChoice::follow);
  /// otherwise none.
  [[nodiscard]] std::vector<SummaryLine> follow_lines() const;
};

/// All decisions for retargeting a clip to a robot. A plain value: every member may be read and
/// replaced before solve().
struct Plan {
  /// The clip as read, cleaned, with scaled travel and moved to a changed scene
  /// (HumanOptions::clean, SolveOptions::travel, ::terrain, ::terrain_scale, ::object_shift,
  /// ::object_scale); null after solve(Plan&&).
  std::shared_ptr<const Clip> clip;
  LoadedRobot robot;
  Options options;  ///< Options as given; the members below take precedence.

  HumanInClip human;

  FrameRange part;         ///< Frames of the clip that are used.
  int lead_in_frames = 0;  ///< Dropped leading frames that are not part of the motion.
  FrameRate rate;          ///< Rate of the motion.

  LimitSet limits;
  ResolvedConfig config;
  bool is_config_of_others = false;  ///< `config` was chosen because the clip is not LAFAN1.
  ScaleRule scale = ScaleRule::kLimbs;
  std::optional<TravelReport> travel;  ///< Set if the travel of `clip` is scaled.
  /// Time scale that prepare_clip applies. With SolveOptions::time_scale `auto`, solve() calls
  /// decide_time_scale to find it.
  std::optional<TimeScale> time_scale;
  FitOptions fit;
  std::shared_ptr<const Scene> scene;  ///< Scene around the human; null: only the floor.
  std::vector<ObjectTrack> object_tracks;
  /// Changes to the contacts that are found in the clip.
  std::vector<ContactEdit> contact_edits;
  /// Reasons why the clip's part, path or scene may be wrong.
  std::vector<Warning> clip_doubts;
  std::vector<SummaryLine> clip_notes;    ///< Omitted parts of the clip, with reasons.
  std::vector<SummaryLine> config_notes;  ///< Omitted parts of the configuration, with reasons.

  /// Reasons why the recognition of the human, or the scene, may be wrong.
  [[nodiscard]] std::vector<Warning> doubts() const;
  /// The robot and its retargeting settings as summary lines.
  [[nodiscard]] std::vector<SummaryLine> robot_lines() const;
  /// All decisions as text, one line each.
  [[nodiscard]] std::string summary() const;
  /// Number of frames of the motion that solve() makes.
  [[nodiscard]] std::int64_t frame_count() const;
};

/// Summary lines as text, with the labels in a column.
[[nodiscard]] std::string summary_text(std::span<const SummaryLine> lines);

/// Recognises and calibrates the human in a clip. If the clip's rotations do not match its
/// positions, they are replaced.
/// @param data_folder  data folder with configs/skeletons; empty: the folder that load_robot finds.
[[nodiscard]] Result<HumanInClip> find_human(Clip& clip, const HumanOptions& options,
                                             const std::string& data_folder);

/// The placement of a human's clip in a world with metres and Z up, with separate colours for left
/// and right, for format_human_glb.
/// @param clip  must outlive the result.
[[nodiscard]] HumanInWorld human_in_world(const Clip& clip, const Calibration& calibration);

/// Checks for contradictory options (kUsage), and for values and files that are wrong for any clip.
[[nodiscard]] Result<void> check_options(const Options& options);

/// Error (kUsage): the base of the robot is fixed, so that its motions have no contacts.
[[nodiscard]] Result<void> check_has_contacts(const Robot& robot);

/// Resolves options for a robot: limits, configurations and fit options.
[[nodiscard]] Result<RobotSetup> set_up_robot(LoadedRobot robot, const Options& options);

/// The configuration with which a motion of a plan is measured. Unlike Plan::config, it has the
/// tasks of bones that the human lacks.
[[nodiscard]] ResolvedConfig measured_config(const Plan& plan, const RobotSetup& robot);

/// Makes the plan for retargeting a clip to a robot.
///
/// Errors: contradictory options (kUsage); a clip without frames or without a human, a part outside
/// the clip, more memory than allowed (kInput); bad option files (kConfig).
[[nodiscard]] Result<Plan> make_plan(Clip clip, const RobotSetup& robot, const Options& options);
[[nodiscard]] Result<Plan> make_plan(Clip clip, const LoadedRobot& robot,
                                     const Options& options = {});

}  // namespace retarget
