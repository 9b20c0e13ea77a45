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

/// The gates of configs/quality/default.json.
[[nodiscard]] Result<Gates> default_gates(const std::string& data_folder);

/// Applies a user's changes to the default gates, in order. A text is the name of a gate file,
/// `METRIC<=MAX`, `METRIC>=MIN`, `METRIC=MAX`, `METRIC=none`, `none` (no gates at all) or `default`
/// (no change; it does not undo `none`). The first text on a metric replaces its gate; further
/// ones add bounds, of which the stricter applies. The suffix after the last `_` of a metric's name
/// may be omitted: `limb_angle` for `limb_angle_deg`. Errors: unknown metrics and invalid numbers
/// (kUsage), errors in a file (kConfig).
[[nodiscard]] Result<Gates> changed_gates(const std::vector<std::string>& texts,
                                          const std::string& data_folder);

/// Help text of the gate option, with all forms of a text.
inline constexpr const char* kGateHelp =
    "Gates that extend or replace configs/quality/default.json: a file like it, 'METRIC<=MAX', "
    "'METRIC>=MIN' (in quotes), METRIC=MAX, METRIC=none, or none for no gates at all; repeatable";

/// The command-line option that collects these texts.
[[nodiscard]] Option gate_row(std::vector<std::string>& texts, const std::string& help = kGateHelp);

struct SceneWorld;

/// The human motion from which a robot's motion was made. Frames with the same index are
/// simultaneous.
struct QualitySource {
  const HumanClip* human = nullptr;  ///< Human motion at the motion's frame rate; may be longer or
                                     ///< shorter.
  const ResolvedConfig* config = nullptr;  ///< Defines the tracked targets; nullptr: no tracking.
  /// Scaling rule of the targets.
  ScaleRule scale = ScaleRule::kTable;
  /// Trunk rule of the targets with which the motion was solved.
  TrunkRule trunk = TrunkRule::kLines;
  /// The scene around the human, in the same frames; null: only the floor.
  const SceneWorld* scene = nullptr;
  /// The scene around the robot; null: `scene`, scaled like the paths.
  const SceneWorld* around_robot = nullptr;
  /// User edits that are applied to the contacts detected in the source.
  std::span<const ContactEdit> contact_edits = {};
  /// Seconds of the motion per second of the source. Contacts are detected at the source's speed.
  double pace = 1.0;
  bool up_is_uncertain = false;  ///< See Calibration::up_is_uncertain.
};

/// Options of measure_quality() and add_dynamics().
struct QualityOptions {
  /// Frame stride of self_1cm_pct and self_max_cm, which use MuJoCo's contact depths.
  int self_collision_stride = 5;
  std::size_t faults_per_metric = 10;  ///< Largest number of faults listed per metric.
};

/// Measures a motion. docs/quality.md and quality_metrics() define the metrics.
/// @param limits  limit set of limit_pct; QualityReport::limit_sets covers all sets of the robot.
/// @param source  null: the report omits metrics that need a source.
/// @pre the clip has frames.
[[nodiscard]] QualityReport measure_quality(const RobotClip& clip, const LimitSet& limits,
                                            const QualitySource* source = nullptr,
                                            const QualityOptions& options = {});

/// Adds the dynamics metrics: the forces and torques that a motion requires by inverse dynamics,
/// and the part that contacts cannot supply. Needs no source. Adds no metric for a robot without
/// mass or with a fixed base, and for fewer than three frames.
/// @param scene  scene around the robot, in the frames of the motion; null: only the floor.
void add_dynamics(const RobotClip& clip, QualityReport& report, const SceneWorld* scene = nullptr,
                  const QualityOptions& options = {});

/// The scene around the robot: that of the source at the scale of a fit. Null if the source has no
/// scene or no configuration, or if the configuration yields no target of a foot.
[[nodiscard]] std::shared_ptr<const SceneWorld> robot_world(const QualitySource& source,
                                                            const Robot& robot);

/// Adds the finger metrics if both robot and source have fingers (docs/hands.md).
/// @param source  clip with the same frames as the motion.
/// @param map     its bone map.
void add_hands(const RobotClip& clip, const Clip& source, const BoneMap& map,
               QualityReport& report);

/// Adds the joints that are at a limit in many frames, and the tasks that push them there.
/// @param clip    motion in the position and heading in which it was solved.
/// @param limits  limits with which it was solved.
void add_limited_joints(const RobotClip& clip, const LimitSet& limits, const QualitySource& source,
                        QualityReport& report);

/// Adds `solver_failures` to the report of a newly solved motion.
void add_solver_failures(std::span<const SolverFailure> failures, QualityReport& report);

/// A source that motions are compared with, prepared from a plan.
struct MeasuredSource {
  std::string name;  ///< File name without folder.
  FrameRate rate;
  HumanClip human;
  std::optional<HumanClip> human_with_lead_in;  ///< Set if the source has a lead-in.
  /// The frames of `human` and `human_with_lead_in` as read from the file, for sources with
  /// fingers; otherwise null.
  std::shared_ptr<const Clip> fingers, fingers_with_lead_in;
  /// The scene around the human in the same frames; null: only the floor.
  std::shared_ptr<const SceneWorld> scene, scene_with_lead_in;
  BoneMap map;
  ResolvedConfig config;
  std::string config_file;  ///< Name of the configuration's file for reports.
  ScaleRule scale = ScaleRule::kTable;
  TrunkRule trunk = TrunkRule::kLines;
  std::optional<TravelReport> travel;      ///< See Plan::travel.
  std::optional<TimeScale> time_scale;     ///< See Plan::time_scale.
  std::vector<ContactEdit> contact_edits;  ///< See Plan::contact_edits.
  bool up_is_uncertain = false;            ///< See Calibration::up_is_uncertain.
};

/// Makes the source of a plan.
/// Errors: those of prepare_clip.
[[nodiscard]] Result<MeasuredSource> measured_source(Plan plan);

/// Drops the first frames of a source, for motions that begin later. At least one frame remains.
void skip_frames(MeasuredSource& source, int frames);

/// The metrics of a motion, and the part of the source that the motion was compared with.
struct MotionMeasure {
  QualityReport report;      ///< Report without gates.
  bool has_lead_in = false;  ///< Whether the motion includes the source's lead-in.
  int source_frames = 0;     ///< Frames of the source, counted from its start; 0: no source.
};

/// Measures a motion from a file. The motion may be with or without the source's lead-in, and may
/// be a part of the source. It is compared with the source frames that its limbs match best.
/// @param motion    at the source's rate.
/// @param source    null: no source.
/// @param dynamics  whether to add the metrics of add_dynamics().
[[nodiscard]] MotionMeasure measure_motion(const RobotClip& motion, const LimitSet& limits,
                                           const MeasuredSource* source, bool dynamics = false);

/// Like evaluate(), with the metrics of add_dynamics() if `dynamics` is set.
[[nodiscard]] Result<QualityReport> evaluate(const Motion& motion, bool dynamics);

/// The command-line option that sets `dynamics`.
[[nodiscard]] Option dynamics_row(bool& dynamics);

/// Style of report_text.
struct ReportStyle {
  bool all = false;     ///< Whether to show all measured values, one per line.
  bool colour = false;  ///< Whether to add ANSI colour codes for a terminal.
};

/// Largest number of lines of a short report of one or a few motions.
inline constexpr int kReportLines = 25;

/// Formats reports in a style. Names of files and joints are made printable.
[[nodiscard]] std::string report_text(std::span<const QualityReport> reports,
                                      const ReportStyle& style);

}  // namespace retarget
