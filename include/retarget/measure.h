#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/solve.h"

namespace RETARGET_API retarget {

/// Returns the gates of configs/quality/default.json.
[[nodiscard]] Result<Gates> default_gates(const std::string& data_folder);

/// Applies a user's changes to the default gates, in order. A text is a file of gates,
/// `METRIC<=MAX`, `METRIC>=MIN`, `METRIC=MAX`, `METRIC=none`, `none` (no gates at all) or `default`
/// (no change; it does not undo `none`). The first text on a metric replaces its gate; `<=` and
/// `>=` on the same metric combine to one gate. The part of a metric's name after the last `_` may
/// be omitted: `limb_angle`. Errors: unknown metrics and invalid numbers (kUsage), errors in a file
/// (kConfig).
[[nodiscard]] Result<Gates> changed_gates(const std::vector<std::string>& texts,
                                          const std::string& data_folder);

/// Help text for commands that describe the gate texts in full.
inline constexpr const char* kGateHelp =
    "Gates that extend or replace configs/quality/default.json: a file like it, 'METRIC<=MAX', "
    "'METRIC>=MIN' (in quotes), METRIC=MAX, METRIC=none, or none for no gates at all; repeatable";

/// Returns the command-line option that collects these texts.
[[nodiscard]] Option gate_row(std::vector<std::string>& texts, const std::string& help = kGateHelp);

struct SceneWorld;

/// The human motion from which a robot's motion was made. Frames with the same index are
/// simultaneous.
struct QualitySource {
  const HumanClip* human = nullptr;  ///< At the motion's frame rate; may be longer or shorter.
  const ResolvedConfig* config = nullptr;  ///< Defines the tracked targets; nullptr: no tracking.
  /// Scaling rule of the targets.
  ScaleRule scale = ScaleRule::kTable;
  /// The scene around the human, in the same frames; null: only the floor.
  const SceneWorld* scene = nullptr;
  /// The scene around the robot; null: `scene`, scaled like the paths.
  const SceneWorld* around_robot = nullptr;
  /// Changes to the contacts that are found in the source.
  std::span<const ContactEdit> contact_edits = {};
};

struct QualityOptions {
  /// Frame stride of self_1cm_pct and self_max_cm, which use MuJoCo's contact depths.
  int self_collision_stride = 5;
  std::size_t faults_per_metric = 10;
};

/// Measures a motion; docs/quality.md and quality_metrics() define the metrics.
/// @param limits  limit set for limit_pct; the report also covers all other sets of the robot.
/// @param source  without it, metrics that need it are omitted.
/// @pre the clip has frames
[[nodiscard]] QualityReport measure_quality(const RobotClip& clip, const LimitSet& limits,
                                            const QualitySource* source = nullptr,
                                            const QualityOptions& options = {});

/// Adds the forces and torques that a motion requires, by inverse dynamics, and the part that
/// contacts can supply. Uses no source. Omitted for a robot without mass and for fewer than three
/// frames.
/// @param scene  around the robot, in the frames of the motion; null: only the floor.
void add_dynamics(const RobotClip& clip, QualityReport& report, const SceneWorld* scene = nullptr,
                  const QualityOptions& options = {});

/// The scene of a source around the robot, with the size and the paths that a fit gives it. Null if
/// the source has no scene, or if its limbs cannot be measured.
[[nodiscard]] std::shared_ptr<const SceneWorld> robot_world(const QualitySource& source,
                                                            const Robot& robot);

/// Adds the tracking errors of the robot's fingers if the source has fingers, too (docs/hands.md).
/// @param source  has the same frames as the motion.
void add_hands(const RobotClip& clip, const Clip& source, const BoneMap& map,
               QualityReport& report);

/// Adds the failures of the solvers for a motion that has just been solved.
void add_solver_failures(std::span<const SolverFailure> failures, QualityReport& report);

/// The source that motions are compared with, as prepared by a plan.
struct MeasuredSource {
  std::string name;  ///< File name without folder.
  FrameRate rate;
  HumanClip human;
  std::optional<HumanClip> human_with_lead_in;  ///< Set if the source has a lead-in.
  /// The same frames as read from the file, for sources with fingers; otherwise null.
  std::shared_ptr<const Clip> fingers, fingers_with_lead_in;
  /// The scene around the human in the same frames; null: only the floor.
  std::shared_ptr<const SceneWorld> scene, scene_with_lead_in;
  BoneMap map;
  ResolvedConfig config;
  std::string config_file;  ///< Recorded name of the file.
  ScaleRule scale = ScaleRule::kTable;
  std::optional<TravelReport> travel;      ///< As in Plan.
  std::optional<TimeScale> time_scale;     ///< As in Plan.
  std::vector<ContactEdit> contact_edits;  ///< As in Plan.
};

/// Errors: those of prepare_clip.
[[nodiscard]] Result<MeasuredSource> measured_source(Plan plan);

/// The metrics of a motion and the part of the source that they refer to.
struct MotionMeasure {
  QualityReport report;      ///< Without gates.
  bool has_lead_in = false;  ///< The motion includes the source's lead-in.
  int source_frames = 0;     ///< Frames of the source, counted from its start; 0: no source.
};

/// Measures a motion from a file. The motion may include the source's lead-in or not, and may be a
/// part of it; it is compared with the source frames that its limbs match.
/// @param motion  at the source's rate.
/// @param source    null: none.
/// @param dynamics  whether to add the metrics of add_dynamics.
[[nodiscard]] MotionMeasure measure_motion(const RobotClip& motion, const LimitSet& limits,
                                           const MeasuredSource* source, bool dynamics = false);

/// Runs retarget::evaluate, and inverse dynamics if `dynamics` is set.
[[nodiscard]] Result<QualityReport> evaluate(const Motion& motion, bool dynamics);

/// Returns the command-line option that sets `dynamics`.
[[nodiscard]] Option dynamics_row(bool& dynamics);

/// Style of report_text.
struct ReportStyle {
  bool all = false;     ///< All measured values, one per line.
  bool colour = false;  ///< Colour the marks of gates, for a terminal.
};

/// Maximum number of lines of a short report, for one motion or several.
inline constexpr int kReportLines = 25;

/// Formats reports in a style. Names of files and joints are made printable.
[[nodiscard]] std::string report_text(std::span<const QualityReport> reports,
                                      const ReportStyle& style);

}  // namespace retarget
