#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/time_scale.h"

namespace RETARGET_API retarget {

/// Definition of a quality metric.
struct Metric {
  std::string_view key;         ///< Name in JSON, gates and tables.
  std::string_view unit;        ///< `%` (of frames unless the definition says otherwise), `rad/s`,
                                ///< ...
  std::string_view definition;  ///< Human-readable, one or two sentences.
  std::string_view source;      ///< Source of the definition.
  /// Whether only some reports have the metric: right after a solve, with a known scene, or with
  /// driven fingers. Reports without the metric skip its gate.
  bool is_conditional = false;
};

/// All metrics, in report order.
[[nodiscard]] std::span<const Metric> quality_metrics();

/// Looks up a metric by its key; nullptr if unknown.
[[nodiscard]] const Metric* find_metric(std::string_view key);

/// True for metrics that only inverse dynamics provides (`--dynamics`).
[[nodiscard]] bool needs_dynamics(const Metric& metric);

/// Keys of all metrics, for messages.
[[nodiscard]] std::vector<std::string> metric_keys();

/// Cost of one term of the fit.
struct FitTermReport {
  std::string name;        ///< Name of the term (docs/fit.md).
  double before = 0.0;     ///< Mean over frames, for the initial motion.
  double after = 0.0;      ///< Mean over frames, for the final motion.
  std::vector<int> worst;  ///< Up to five frames with the highest final cost, worst first, at
                           ///< least half a second apart.
};

/// A joint whose final motion was changed to keep its position and speed limits.
struct FitBoundReport {
  std::string joint;
  int frames = 0;        ///< Number of changed frames.
  int worst_frame = 0;   ///< Frame with the largest change.
  double largest = 0.0;  ///< Largest change, rad or m.
};

/// Solver status of a fit, for one window of a clip or summarised over the clip.
struct FitStatus {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  /// Whether the predicted cost reduction of the last step was at most the fraction kFitTolerance.
  /// For a whole clip: true if all windows converged.
  bool converged = false;
  int steps = 0;  ///< Gauss-Newton steps taken; for the clip: the maximum over the windows.
  /// Number of diagonal blocks that were not positive definite or not finite. Its window then skips
  /// the step and increases the block's damping for the next step.
  int failed_blocks = 0;
  /// Predicted relative cost decrease of the last step; 1 if it failed or no step was taken. For
  /// the clip: the maximum over the windows.
  double predicted_decrease = 1.0;
  /// Total cost of all terms, summed over the frames; 0 without SolveControl::fit_costs.
  double cost_before = 0.0, cost_after = 0.0;
  /// Number of frames without the term `dynamics`, because their contacts are unknown.
  int distrusted_frames = 0;
  /// Whether the steps were repeated without the term `dynamics`, because it did not improve the
  /// result.
  bool dynamics_taken_back = false;
  /// Whether a step had non-finite values and was rejected. For the clip: in at least one window.
  bool failed = false;
  /// Whether the steps were repeated without dynamics, because a step had non-finite values.
  bool dynamics_failed = false;
};

/// Frames in which a solver rejected a step with non-finite values. The frames are finite, but may
/// deviate from their targets.
struct SolverFailure {
  std::string solver;      ///< `fit`, `fit with dynamics`, `left hand`, `right hand`.
  int begin = 0, end = 0;  ///< Frames [begin, end).
};

/// Largest predicted relative cost reduction of a converged fit; see FitStatus::converged.
inline constexpr double kFitTolerance = 0.01;

/// Results of a fit.
struct FitReport {
  double floor_height = 0.0;  ///< Distance by which the targets were lowered, metres.
  bool floor_found = false;   ///< False: the source's feet never stand; the height is an estimate.
  int contact_phases = 0;     ///< Number of heel and toe contact phases.
  std::vector<FitTermReport> terms;  ///< Empty without SolveControl::fit_costs.
  std::vector<FitBoundReport> bounded;
  FitStatus status;                ///< Summary over the whole clip.
  std::vector<FitStatus> windows;  ///< Windows in order, then the seams between them.
  std::vector<SolverFailure> failures;
  /// Messages: omitted terms with the reason, recovered limbs, moved objects.
  std::vector<std::string> notes;
};

/// Factors by which the horizontal path of the source was scaled before the fit.
struct TravelReport {
  double factor = 1.0;                 ///< Mean over the path of the hips.
  double least = 1.0, greatest = 1.0;  ///< Minimum and maximum over the frames.
};

/// Value of a metric for one motion.
struct MetricValue {
  const Metric* metric = nullptr;
  double value = 0.0;
  std::optional<double> p95;  ///< 95th percentile, for metrics with a mean and a 95th percentile.
};

/// Comparison of a motion with one set of joint limits.
struct LimitSetResult {
  std::string name;
  double frames_pct = 0.0;  ///< Frames with a joint beyond its range by more than 1e-6 rad or m.
  double frames_1mrad_pct = 0.0;  ///< Frames with an excess of more than 1e-3 rad or m.
  double worst_excess = 0.0;      ///< Largest excess beyond a limit, rad or m; 0: none.
  std::string joint;              ///< Joint with the largest excess; empty: none.
  int frame = 0;                  ///< Frame with the largest excess.
};

/// Tracking error of a body.
struct TrackingRow {
  int table = 2;  ///< Table of the configuration, 1 or 2.
  std::string body, bone;
  /// Distance between the body and the scaled bone, both relative to the root; mean and 95th
  /// percentile, centimetres. Empty for rows without a position weight.
  std::optional<double> position_cm, position_p95_cm;
  /// Angle between the body and the bone's axes with the offset, degrees. Empty for rows without a
  /// rotation weight.
  std::optional<double> rotation_deg, rotation_p95_deg;
  /// Both errors per frame, in the same units. Only the last row of a body has them, because its
  /// table determines the result.
  std::vector<float> position_errors_cm, rotation_errors_deg;
};

/// Angle between a limb of the robot and the human's.
struct SegmentAngle {
  std::string name;  ///< `left thigh`, `trunk`, ...
  double mean_deg = 0.0, p95_deg = 0.0;
};

/// Mean trunk lean, degrees. The lean is the angle between the vertical and a trunk-fixed direction
/// that is vertical when the body stands.
struct TrunkLean {
  double human = 0.0, robot = 0.0;
  /// Angle between the vertical and the line from mid-hip to mid-shoulder.
  double human_line = 0.0, robot_line = 0.0;
  /// Angle between the two trunk directions, with a constant yaw removed.
  double between = 0.0;
  /// Angle of the mid-hip to mid-shoulder line when the body stands.
  double human_standing = 0.0, robot_standing = 0.0;
};

/// The joint that is at a limit in the largest number of frames.
struct JointMostAtLimit {
  std::string joint;
  bool at_upper = false;    ///< Whether it is at the upper limit.
  double frames_pct = 0.0;  ///< Percentage of the frames at the limit.
};

/// A joint that is at a limit in many frames, and the task that pushes it there.
struct LimitedJoint {
  std::string joint;
  bool at_upper = false;    ///< Whether it is at the upper limit.
  int frames = 0;           ///< Number of frames at the limit.
  double frames_pct = 0.0;  ///< Percentage of the frames at the limit.
  std::string task;         ///< Bone of the task; empty: no task pushes the joint.
  bool rotation = false;    ///< Whether the task's rotation pushes the joint; else its position.
  double shortfall = 0.0;   ///< Remaining error of the task: degrees (rotation) or cm.
  std::string wider_set;    ///< A limit set of the robot with a wider limit; empty: none.
  /// Difference of the limits, rad or m; empty: that set has no limit here.
  std::optional<double> wider;
};

/// A run of consecutive bad frames.
struct Fault {
  std::string metric;  ///< Key of the metric.
  std::string where;   ///< Joint, body or pair of bodies.
  int begin = 0;       ///< First frame.
  int end = 0;         ///< One past the last frame.
  int worst_frame = 0;
  double amount = 0.0;  ///< Value in the worst frame.
  std::string unit;     ///< Unit of `amount`.
};

/// Number of faults of a metric. A report lists only the worst faults.
struct FaultTotal {
  std::string metric;
  int count = 0;
};

/// Result of a gate.
struct GateResult {
  std::string metric;
  std::optional<double> min, max;  ///< Bounds for the value, inclusive.
  std::optional<double> value;     ///< Empty: the metric was not measured.
  /// True if the metric was not measured, except if the user named it (Gate::named) or the source
  /// lost its stances (QualityReport::lost_stances); conditional metrics may always be missing.
  bool passed = true;
};

/// Quality of a motion. It omits metrics whose data are missing: a source clip, soles, collision
/// shapes, enough frames.
struct QualityReport {
  std::string file;  ///< File name of the motion, without folder.
  std::string robot;
  int frames = 0;
  double fps = 30.0;
  std::string limits;     ///< Name of the limit set used for limit_pct.
  std::string source;     ///< File name of the source clip, without folder; empty: none.
  std::string config;     ///< File of the tracked configuration; empty: no source.
  int source_frames = 0;  ///< Frames of the motion that the source covers.
  /// Set if the motion is compared with a source whose travel was scaled (SolveOptions::travel).
  std::optional<TravelReport> travel;
  std::optional<TimeScale> time_scale;  ///< Set if the motion was slowed.
  /// Leg length of the robot (hip to knee to ankle), metres; needs a source and a configuration.
  std::optional<double> leg;
  int speed_limits_given = 0;        ///< Output joints with a speed limit in the robot's profile.
  int speed_limits_assumed = 0;      ///< Output joints without one; compared with the defaults.
  double assumed_speed_limit = 0.0;  ///< Default of hinges, rad/s.
  /// Method by which the soles were estimated; feet may then float or sink although their gates
  /// pass. Empty: the soles are not estimated, or the robot has a fixed base.
  std::string estimated_soles;
  std::vector<MetricValue> values;  ///< Ordered as quality_metrics().
  std::vector<LimitSetResult> limit_sets;
  std::vector<TrackingRow> tracking;
  std::vector<SegmentAngle> segments;
  std::optional<TrunkLean> trunk_lean;  ///< Needs a source with known hips and shoulders.
  /// The joint that is at a limit in the most frames in which the human's pose does not demand it.
  /// If the demand is unknown, all frames are included. Empty: no joint.
  std::optional<JointMostAtLimit> at_limit;
  /// The joint that is at a limit in the most frames in which the human's pose demands it. Empty:
  /// no joint, or the demand is unknown.
  std::optional<JointMostAtLimit> beyond_range;
  SourceContacts contacts;  ///< Heel and toe contacts of the source.
  /// Whether the source has no stance although it is upright, without another support, for two
  /// seconds or more, or although it may only seem to lie (Calibration::up_is_uncertain).
  bool lost_stances = false;
  /// Joints at a limit in at least 5 % of the frames, most frames first; needs a source and a
  /// configuration.
  std::vector<LimitedJoint> limited_joints;
  /// Results of the fit; only for a motion that has just been fitted.
  std::optional<FitReport> fit;
  std::vector<Fault> faults;             ///< Grouped by metric, worst first.
  std::vector<FaultTotal> fault_totals;  ///< One per metric with faults.
  std::vector<GateResult> gates;

  /// Value of a metric; nullptr if it was not measured.
  [[nodiscard]] const MetricValue* find(std::string_view key) const;
  /// Whether all gates passed.
  [[nodiscard]] bool passed() const;
};

/// Formats reports as JSON (schema: docs/quality.md). Floating-point numbers round-trip exactly.
[[nodiscard]] std::string report_json(std::span<const QualityReport> reports);

/// Formats reports as human-readable text of about 25 lines: the verdict, missed gates with their
/// worst frames, then the gates by group. Several motions are columns of one table.
[[nodiscard]] std::string report_text(std::span<const QualityReport> reports);

/// Bounds for a metric, inclusive.
struct Gate {
  std::string metric;  ///< Metric key.
  std::optional<double> min, max;
  /// Leg length (hip to knee to ankle) that the bounds refer to, metres. The bounds scale with the
  /// robot's leg length. Empty: the same bounds for every robot.
  std::optional<double> leg = std::nullopt;
  bool named = false;  ///< The user named this metric, so it must be measured: `METRIC<=N`.
};

/// A set of gates, at most one per metric.
class Gates {
 public:
  /// Adds a gate, replacing one on the same metric. A gate without bounds removes it.
  void set(Gate gate);
  void clear() { gates_.clear(); }
  [[nodiscard]] const std::vector<Gate>& all() const { return gates_; }
  /// True if a gate is on a metric that only inverse dynamics provides.
  [[nodiscard]] bool need_dynamics() const;

  /// Sets all gates of a JSON file:
  /// `{"gates": {KEY: {"min": NUMBER, "max": NUMBER, "leg_m": NUMBER}, ...}}`. A plain number is a
  /// maximum, `null` removes the gate. Other members of the file are ignored. A kConfig error
  /// reports all problems at once, and the nearest name for an unknown metric.
  [[nodiscard]] Result<void> add_json(std::string_view text, const std::string& file);
  [[nodiscard]] Result<void> add_file(const std::string& path);

  /// Checks a report against the gates and stores the results in the report. Gates on metrics with
  /// Metric::is_conditional are skipped where the report lacks the metric.
  void judge(QualityReport& report) const;

 private:
  std::vector<Gate> gates_;
};

}  // namespace retarget
