#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"

namespace RETARGET_API retarget {

/// A figure of merit of a motion.
struct Metric {
  std::string_view key;         ///< Its name in JSON, gates and tables.
  std::string_view unit;        ///< `%` (of frames unless the definition says otherwise), `rad/s`,
                                ///< ...
  std::string_view definition;  ///< Human-readable, one or two sentences.
  std::string_view source;      ///< Where the definition comes from.
};

/// All metrics, in report order.
[[nodiscard]] std::span<const Metric> quality_metrics();

/// By key; nullptr for an unknown one.
[[nodiscard]] const Metric* find_metric(std::string_view key);

/// All keys, for messages.
[[nodiscard]] std::vector<std::string> metric_keys();

/// How much a term of the fit costs, and where.
struct FitTermReport {
  std::string name;        ///< As in docs/fit.md.
  double before = 0.0;     ///< Mean over frames, for the motion that the fit starts from.
  double after = 0.0;      ///< The same at the end.
  std::vector<int> worst;  ///< Up to five frames where it is worst at the end, worst first, at
                           ///< least half a second apart.
};

/// A joint whose motion had to be changed at the end to keep the limits.
struct FitBoundReport {
  std::string joint;
  int frames = 0;        ///< How many frames were changed.
  int worst_frame = 0;   ///< Where it was changed most ...
  double largest = 0.0;  ///< ... and by how much, rad or m.
};

/// How the steps of a fit ended, on one window of a clip or on all of it.
struct FitStatus {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  /// The last step was predicted to lower the cost by no more than kFitTolerance of it. Of all:
  /// every window's was.
  bool converged = false;
  int steps = 0;  ///< Gauss-Newton steps that were taken; of all: the most that a window took.
  /// Blocks of the system that were not positive definite (or not finite). Each cost its window a
  /// step and is damped more in the next one.
  int failed_blocks = 0;
  /// By how much of the cost the last step was predicted to lower it; 1 where it failed or none was
  /// taken. Of all: the largest.
  double predicted_decrease = 1.0;
  double cost_before = 0.0, cost_after = 0.0;  ///< Sums over the frames, of all terms.
  /// Frames that the term `dynamics` left as they are, for what carries the robot there is not known.
  int distrusted_frames = 0;
  bool dynamics_taken_back = false;  ///< It helped nothing: the steps were taken without it.
};

/// See FitStatus::converged.
inline constexpr double kFitTolerance = 0.01;

/// Results of a fit.
struct FitReport {
  double floor_height = 0.0;  ///< By how much the targets were lowered, metres.
  bool floor_found = false;   ///< False: no foot of the source stands; the height is a guess.
  int contact_phases = 0;     ///< Of heels and toes.
  std::vector<FitTermReport> terms;
  std::vector<FitBoundReport> bounded;
  FitStatus status;                ///< Of the whole clip.
  std::vector<FitStatus> windows;  ///< Windows in order, then the seams between them.
  /// Terms that the robot or the source cannot have, and why; steps that have not converged.
  std::vector<std::string> notes;
};

/// A metric's figure for one motion.
struct MetricValue {
  const Metric* metric = nullptr;
  double value = 0.0;
  std::optional<double> p95;  ///< Of metrics that give mean and 95th percentile.
};

/// How well a motion respects one set of joint limits.
struct LimitSetResult {
  std::string name;
  double frames_pct = 0.0;        ///< Frames with a joint beyond its range by more than 1e-6,
  double frames_1mrad_pct = 0.0;  ///< and by more than 1e-3 (rad or m).
  double worst_excess = 0.0;      ///< Largest amount beyond a limit, rad or m; 0: none.
  std::string joint;              ///< The joint in question; empty: none is beyond.
  int frame = 0;
};

/// How well a body follows its bone.
struct TrackingRow {
  int table = 2;  ///< Of the configuration, 1 or 2.
  std::string body, bone;
  /// Distance of the body, as seen from the root, from the scaled bone; mean and 95th percentile,
  /// centimetres. Empty for rows without position weight.
  std::optional<double> position_cm, position_p95_cm;
  /// Angle from the bone's offset axes, degrees. Empty for rows without rotation weight.
  std::optional<double> rotation_deg, rotation_p95_deg;
  /// Both frame by frame, in the same units: of the last row of a body, whose table it is judged by.
  std::vector<float> position_errors_cm, rotation_errors_deg;
};

/// Angle between a limb of the robot and the human's.
struct SegmentAngle {
  std::string name;  ///< `left thigh`, `trunk`, ...
  double mean_deg = 0.0, p95_deg = 0.0;
};

/// Lean of the trunks; means, degrees. The lean is the angle between the vertical and the direction
/// that is vertical when the body stands, carried by its trunk.
struct TrunkLean {
  double human = 0.0, robot = 0.0;
  /// Of the bare line from the middle of the hips to the middle of the shoulders,
  double human_line = 0.0, robot_line = 0.0;
  /// Between both directions, a constant yaw removed.
  double between = 0.0;
  /// Of the line when the body stands.
  double human_standing = 0.0, robot_standing = 0.0;
};

/// The joint that is at a limit in most frames.
struct JointMostAtLimit {
  std::string joint;
  bool at_upper = false;
  double frames_pct = 0.0;
};

/// A joint that is at a limit in many frames, and what pushes it there.
struct LimitedJoint {
  std::string joint;
  bool at_upper = false;
  int frames = 0;
  double frames_pct = 0.0;
  std::string task;             ///< The followed bone; empty: nothing pushes.
  bool rotation = false;        ///< The task's rotation; else its position.
  double shortfall = 0.0;       ///< Of the task: degrees, or cm.
  std::string wider_set;        ///< A limit set of the robot that is wider there; empty: none,
  std::optional<double> wider;  ///< by so much, rad or m; empty: it has no limit there.
};

/// A run of frames in which something is wrong.
struct Fault {
  std::string metric;  ///< Key of the metric it belongs to.
  std::string where;   ///< Joint, body or pair of bodies.
  int begin = 0;       ///< First frame,
  int end = 0;         ///< and the one after the last.
  int worst_frame = 0;
  double amount = 0.0;  ///< In the worst frame.
  std::string unit;     ///< Of the amount.
};

/// How many faults of a metric there are; a report has only the worst of them.
struct FaultTotal {
  std::string metric;
  int count = 0;
};

/// A gate on a metric, and whether it passed.
struct GateResult {
  std::string metric;
  std::optional<double> min, max;  ///< Bounds for the figure, inclusive.
  std::optional<double> value;     ///< Empty: the metric was not measured.
  bool passed = true;              ///< True where nothing was measured.
  /// Why the gate is off for this motion, which passes it then; empty: it applies.
  std::string not_applicable;
};

/// A motion's figures. Metrics that need missing data (a source clip, soles, collision shapes,
/// enough frames) are omitted.
struct QualityReport {
  std::string file;  ///< The motion's, without folder.
  std::string robot;
  int frames = 0;
  double fps = 30.0;
  std::string limits;          ///< Name of the limit set used for limit_pct.
  std::string source;          ///< The source clip's file, without folder; empty: none.
  std::string config;          ///< File of the configuration that is tracked; empty: no source.
  int source_frames = 0;       ///< Frames of the motion that the source covers.
  std::optional<double> leg;   ///< Hip to knee to ankle, metres; with a source and a configuration.
  int speed_limits_given = 0;  ///< Output joints with a speed limit of the robot's profile,
  int speed_limits_assumed = 0;      ///< and without: their hinges are compared with
                                     ///< assumed_speed_limit.
  double assumed_speed_limit = 0.0;  ///< rad/s
  std::vector<MetricValue> values;   ///< In the order of quality_metrics().
  std::vector<LimitSetResult> limit_sets;
  std::vector<TrackingRow> tracking;
  std::vector<SegmentAngle> segments;
  std::optional<TrunkLean> trunk_lean;       ///< With a source whose hips and shoulders are known.
  std::optional<JointMostAtLimit> at_limit;  ///< Empty: no joint ever is.
  SourceContacts contacts;                   ///< Of the source's heels and toes.
  /// At a limit in at least a twentieth of the frames, most frames first; with a source and a configuration.
  std::vector<LimitedJoint> limited_joints;
  /// If the motion has just been fitted: the cost of its terms, and what had to be bounded.
  std::optional<FitReport> fit;
  std::vector<Fault> faults;             ///< By metric; the worst first.
  std::vector<FaultTotal> fault_totals;  ///< Of metrics with faults.
  std::vector<GateResult> gates;

  [[nodiscard]] const MetricValue* find(std::string_view key) const;
  [[nodiscard]] bool passed() const;
};

/// The reports as JSON (docs/quality.md has the schema). Floating-point numbers have enough digits
/// to be read back unchanged.
[[nodiscard]] std::string report_json(std::span<const QualityReport> reports);

/// Human-readable: one row per metric, one column per motion, then missed gates and the worst
/// frames.
[[nodiscard]] std::string report_text(std::span<const QualityReport> reports);

/// Switches a gate off for motions with a figure above this.
struct GateException {
  std::string metric;  ///< Key.
  double above = 0.0;
};

/// Bounds for a metric, inclusive.
struct Gate {
  std::string metric;  ///< Key.
  std::optional<double> min, max;
  /// The bounds are for a robot with legs (hip to knee to ankle) of this length, metres; for others
  /// they scale with the legs. Empty: for every robot.
  std::optional<double> leg = std::nullopt;
  std::vector<GateException> unless = {};  ///< Any of them is enough.
};

/// Gates, at most one for each metric.
class Gates {
 public:
  /// Replaces the gate on the same metric; a gate without bounds removes it.
  void set(Gate gate);
  void clear() { gates_.clear(); }
  [[nodiscard]] const std::vector<Gate>& all() const { return gates_; }

  /// Sets every gate of a file: JSON
  /// `{"gates": {KEY: {"min": NUMBER, "max": NUMBER, "leg_m": NUMBER, "unless": {KEY: NUMBER}},
  /// ...}}`; a number is a maximum, `null` removes the gate, `unless` switches it off above a
  /// figure. Other members of the file are ignored. kConfig errors report everything at once,
  /// unknown metrics with the nearest name.
  [[nodiscard]] Result<void> add_json(std::string_view text, const std::string& file);
  [[nodiscard]] Result<void> add_file(const std::string& path);

  /// Checks a report against the gates and stores the results in it.
  void judge(QualityReport& report) const;

 private:
  std::vector<Gate> gates_;
};

}  // namespace retarget
