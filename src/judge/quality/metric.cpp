#include "retarget/report.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "judge/quality/metric_group.h"

namespace retarget {
namespace {

constexpr std::string_view kOwn = "own";
constexpr std::string_view kNotes = "measurements of the published G1 data";
constexpr std::string_view kHolosoma = "holosoma evaluation, 1 cm";
constexpr std::string_view kContacts = "contacts of the source foot: contact_plan.h";
constexpr std::string_view kDynamics = "inverse dynamics: docs/dynamics.md";
constexpr std::string_view kCertificate = "certificates: docs/certificate.md";

// Steps are between consecutive frames; speeds are steps times the frame rate. difference_stride()
// has the exception.
constexpr auto kMetrics = std::to_array<Metric>({
    {"solver_failures", "count",
     "Frame ranges of a newly solved motion in which a solver met non-finite numbers: it rejected "
     "these steps, and the frames may deviate from their targets.",
     kOwn, true},
    {"limit_pct", "%", "Frames with a joint beyond its limits by more than 1e-6 rad or m.", kOwn},
    {"limit_max_rad", "rad", "Largest excess of a joint beyond its limits; 0 within the limits.",
     kOwn},
    {"at_limit_pct", "%",
     "Frames with a joint beyond a limit or within 0.01 rad of it (or a hundredth of its range if "
     "that is less); excludes frames in which the human lies, heads, hands, and limits reached in "
     "the zero configuration.",
     kOwn},
    {"joint_at_limit_pct", "%",
     "The same for the joint and limit with the most frames, excluding frames in which the human's "
     "pose demands this position or one beyond it; `at_limit` names them.",
     kOwn},
    {"joint_beyond_range_pct", "%",
     "Frames in which a joint is at a limit because the human's pose demands this position or one "
     "beyond it, for the joint and limit with the most such frames; `beyond_range` names them.",
     kOwn},
    {"joint_frames_at_limit_pct", "%",
     "Share of joints at a limit over all counted joints and frames, by the rules of at_limit_pct.",
     kOwn},
    {"speed_limit_pct", "%",
     "Steps in which a joint is faster than its speed limit (by more than 1e-6 rad per step).",
     kNotes},
    {"speed_limit_max_ratio", "1", "Largest ratio of a joint's speed to its limit.", kNotes},
    {"peak_speed", "rad/s", "Largest speed of a joint.", kNotes},
    {"fast_3pi_pct", "%", "Steps in which a joint is faster than 3 pi rad/s.",
     "nominal joint speed of the published method"},
    {"jumps", "count", "Steps of single joints above 0.5 rad.", kNotes},
    {"jump_frames", "count", "Steps between frames in which some joint moves more than 0.5 rad.",
     kNotes},
    {"max_step_rad", "rad", "Largest step of a joint.", kOwn},
    {"acc_rms", "rad/s^2", "Root mean square of all joints' accelerations (second differences).",
     kNotes},
    {"acc_p99", "rad/s^2",
     "99th percentile over frames of the largest joint acceleration in a frame.", kNotes},
    {"root_jerk_mean", "m/s^3",
     "Mean length of the root position's third difference, over steps of at least 1/180 s.",
     "PHUMA, under 50"},
    {"root_jerk_p99", "m/s^3", "99th percentile of the same length.", "PHUMA"},
    {"root_acc_p99", "m/s^2",
     "99th percentile over frames of the root's acceleration, computed with a cubic spline through "
     "its positions.",
     kOwn},
    {"root_acc_max", "m/s^2", "Largest value of the same acceleration.", kOwn},
    {"com_acc_rms", "m/s^2",
     "Root mean square over frames of the acceleration of the centre of mass, computed with a "
     "cubic spline through its positions.",
     kOwn},
    {"com_acc_p99", "m/s^2", "99th percentile of the same acceleration.", kOwn},
    {"root_jumps", "count",
     "Steps in which the root moves faster than 10 m/s or rotates faster than 20 rad/s; gymnasts "
     "and dancers in LAFAN1 stay below 5 and 13.",
     kOwn},
    {"foot_pen_1cm_pct", "%", "Frames with a sole point more than 1 cm below the floor.",
     kHolosoma},
    {"foot_pen_max_cm", "cm", "Depth of the deepest sole point; if negative, its smallest height.",
     kHolosoma},
    {"body_pen_1cm_pct", "%",
     "Frames with a sole point or collision primitive more than 1 cm below the floor.", kHolosoma},
    {"body_pen_max_cm", "cm",
     "Depth of the deepest of these points; if negative, their smallest height.", kHolosoma},
    {"float_2cm_pct", "%",
     "Frames with every sole point and primitive more than 2 cm above the floor, including "
     "flights.",
     kNotes},
    {"sole_height_p50_cm", "cm", "Median over frames of the lowest sole point's height.", kNotes},
    {"flat_slip_p50", "m/s",
     "Median horizontal speed of the centre of a sole whose points are all below 2 cm at both ends "
     "of the step.",
     kNotes},
    {"flat_slip_p95", "m/s", "95th percentile of the same speed.", kNotes},
    {"self_1cm_pct", "%",
     "Share of every fifth frame in which primitives of two bodies penetrate by more than 1 cm "
     "(MuJoCo's contact depth), excluding allowed pairs.",
     kOwn},
    {"self_max_cm", "cm", "Depth of the deepest of these penetrations; 0 without penetration.",
     kOwn},
    {"self_all_1cm_pct", "%",
     "The same for every frame and with the exact depth: the shortest translation that separates "
     "the two primitives.",
     kOwn},
    {"self_all_max_cm", "cm", "Depth of the deepest of these penetrations.", kOwn},
    {"self_crossing_max_cm", "cm",
     "Depth of the deepest penetration of two bodies half-way between two frames, for bodies that "
     "move by more than 6 cm relative to each other: they pass through each other between the "
     "frames.",
     kOwn},
    {"float_planted_pct", "%",
     "Frames in which heel and toe of a source foot are in contact and every sole point and "
     "primitive is more than 2 cm above the floor.",
     kContacts},
    {"hover_pct", "%",
     "Frames in which the robot hovers: every sole point and primitive is more than 2 cm above the "
     "floor, and above the clearance of the source's lowest part, scaled, while the source is not "
     "in flight.",
     kOwn},
    {"missing_surface_pct", "%",
     "Share of the frames with a known support in which only surfaces above the floor carry the "
     "source, through its feet or a seat, and the robot touches no body of the scene: it stands or "
     "sits on nothing. Flights of at most a second between two such supports count, and flights "
     "between other supports are part of the frames. Frames without a known support count while "
     "the robot stays in the air for more than a second. The denominator is at least a quarter of "
     "all frames.",
     kContacts},
    {"lying_pct", "%",
     "Frames in which the source lies or crawls: its trunk leans by more than 60 degrees, and its "
     "hips are lower than three quarters of its leg length.",
     kOwn},
    {"source_slide_mean", "m/s",
     "Mean excess of the speed of the source's slowest ankle or toe over the speed of its hips: "
     "supporting feet are at rest, and feet in the air move with the body.",
     kOwn},
    {"contact_pct", "%",
     "Feet and frames in which heel and toe of the source foot are in contact with the floor (of a "
     "foot without a toe joint, the heel).",
     kContacts},
    {"contact_slip_mean", "m/s",
     "Mean horizontal speed of the centre of the sole during these contacts.",
     "GMD foot skating, with contacts from the source as in OmniRetarget"},
    {"contact_slip_p95", "m/s", "95th percentile of the same speed.", kOwn},
    {"contact_drift_p95_cm", "cm",
     "Largest horizontal distance of the centre of the sole from its median position within a "
     "contact; 95th percentile over contacts.",
     kOwn},
    {"contact_height_p50_cm", "cm", "Median height of the lowest sole point during these contacts.",
     kOwn},
    {"contact_agreement_pct", "%",
     "Feet and frames in which source and robot agree on whether the foot stands: the robot's foot "
     "stands while its lowest sole point is below 2 cm and the centre of its sole is slower than "
     "0.25 m/s.",
     "PHUMA and OmniRetarget, contact preservation"},
    {"contact_kept_pct", "%",
     "Share of the feet and frames of contact_pct in which the robot's foot stands.",
     "OmniRetarget, contact preservation"},
    {"stance_pct", "%",
     "Feet and frames in which the source foot is in contact on its sole: the foot's up direction "
     "when standing is at most 41 degrees from the vertical; excludes half a second before and "
     "after frames in which the human lies.",
     kContacts},
    {"stance_slip_mean", "m/s", "contact_slip_mean over these stances.", kOwn},
    {"stance_drift_p95_cm", "cm", "contact_drift_p95_cm over these stances.", kOwn},
    {"stance_height_p50_cm", "cm", "contact_height_p50_cm over these stances.", kOwn},
    {"support_pct", "%",
     "Number of knees, elbows, hands, seat and back of the source on the floor, summed over "
     "frames.",
     kOwn},
    {"support_slip_mean", "m/s",
     "Mean horizontal speed of the robot's corresponding body while the source's is on the floor, "
     "relative to the source's slide, scaled, after removing a constant yaw; 0 if there is no such "
     "contact.",
     kOwn},
    {"support_drift_p95_cm", "cm",
     "Largest horizontal distance of this body, without the slide, from its median position within "
     "such a contact; 95th percentile over contacts.",
     kOwn},
    {"support_height_p50_cm", "cm",
     "Median height of the body's lowest primitive during these contacts.", kOwn},
    {"support_height_p95_cm", "cm", "95th percentile of the same height.", kOwn},
    {"scene_pen_1cm_pct", "%",
     "Frames in which a collision primitive or sole point is more than 1 cm inside a body of the "
     "scene.",
     kHolosoma, true},
    {"scene_pen_max_cm", "cm", "Depth of the deepest of these penetrations.", kHolosoma, true},
    {"scene_contact_pct", "%",
     "Number of knees, elbows, hands, seat, back and feet of the source on bodies of the scene, "
     "summed over frames.",
     kOwn, true},
    {"scene_contact_kept_pct", "%",
     "Share of these contacts in which the robot's corresponding part is within 3 cm of the body.",
     "OmniRetarget, contact preservation", true},
    {"scene_gap_p95_cm", "cm",
     "Distance of the robot's part from the surface, inside or outside, in these contacts; 95th "
     "percentile.",
     kOwn, true},
    {"scene_contact_precision_pct", "%",
     "Share of the frames with a part of the robot within 2 cm of a body in which the source's "
     "part touches this body, at most two frames earlier or later; feet are excluded.",
     kOwn, true},
    {"scene_contact_recall_pct", "%",
     "Share of the contacts of the source's parts in which the robot's part is within 2 cm, at "
     "most two frames earlier or later; feet are excluded.",
     kOwn, true},
    {"scene_slip_mean", "m/s",
     "Mean speed of the robot's part relative to the body while the source's part touches it "
     "without sliding.",
     kOwn, true},
    {"flights", "count",
     "Flights of the source: no toe or ankle near its standing height for 0.1 s while the hips "
     "rise and fall as in free fall.",
     kContacts},
    {"flight_peak_max_cm", "cm",
     "Largest difference, over flights, of the robot's peak sole height (of the lowest sole point) "
     "from the source's peak clearance of the lower foot, scaled.",
     kOwn},
    {"track_pos_cm", "cm",
     "Distance between bodies and the scaled bones that they follow, both relative to the root, "
     "after removing a constant yaw: rows of table 2 with position weight, without the root. Mean "
     "and 95th percentile.",
     "MPJPE, root-relative"},
    {"track_rot_deg", "deg",
     "Angle between bodies and the offset axes of the bones that they follow (with limb scaling: "
     "the target axes of the fit): rows of table 2 with rotation weight. Mean and 95th percentile.",
     kOwn},
    {"limb_angle_deg", "deg",
     "Angle between the robot's and the human's limbs (from joint to joint, after removing a "
     "constant yaw): thighs, shins, upper arms, forearms, trunk, hip and shoulder line. Mean and "
     "95th percentile.",
     kOwn},
    {"worst_limb_angle_deg", "deg",
     "The same for the limb with the largest mean, excluding frames in which the human lies.",
     kOwn},
    {"arm_jolts", "count",
     "Number of times that an arm that cannot reach its target direction drags the trunk along: "
     "the trunk or the shoulder line turns by more than 12 degrees relative to the human's within "
     "0.1 s while an upper arm is more than 25 degrees off. Events are at least half a second "
     "apart; frames in which the human lies are excluded.",
     kOwn},
    {"trunk_lean_error_deg", "deg",
     "Difference between the robot's lean and the human's: angle from the vertical of the line "
     "from hips to shoulders, each relative to its own standing pose. Mean and 95th percentile, "
     "excluding frames in which the human lies.",
     kOwn},
    {"root_slide_mean", "m/s",
     "Mean horizontal speed, over two seconds, at which the root deviates from the source's scaled "
     "path, after removing a constant yaw.",
     kOwn},
    {"root_bounce_pct", "%",
     "Vertical movement of the root between 2.5 and 8 Hz (steps, landings, accents), root mean "
     "square, relative to that of its target; 100 if the target moves by less than 1 mm. For clips "
     "of at least one second at 20 frames per second or more.",
     kOwn},
    {"lag_s", "s",
     "Delay of the robot's limbs behind the human's: the shift of up to half a second that "
     "maximises the correlation of their angular rates. For clips of at least one second with limb "
     "movement; 0.5 if the limbs move by at least 0.3 rad/s and no shift correlates by 0.3.",
     kOwn},
    {"fast_arm_pct", "%",
     "Angular speed of the robot's upper arms and forearms relative to the human's, over 0.1 s, in "
     "the fastest 2 % of the frames of each human limb. Excludes frames in which the floor may "
     "constrain the limb. The value is that of both arms together, or the lower one of a single "
     "arm "
     "that is faster than 2 rad/s for at least 0.2 s. For clips of at least one second with arms "
     "faster than 2 rad/s for at least 0.1 s.",
     kOwn},
    {"fast_leg_pct", "%", "The same for thighs and shins.", kOwn},
    {"joint_offset_rad", "rad",
     "Constant offset of a joint that, subtracted from this joint alone in all frames, brings the "
     "limbs that it carries closest to the human's; largest over joints. If the same joint of both "
     "arms has an offset: the difference, or half of the larger offset if that is more.",
     kOwn},
    {"finger_angle_deg", "deg",
     "Angle between the segments of the robot's and the human's fingers at equal fractions of "
     "their lengths, both relative to the palm, without thumbs. Mean and 95th percentile.",
     kOwn},
    {"driven_finger_angle_deg", "deg",
     "The same for motions with driven fingers; omitted for relaxed hands.", kOwn, true},
    {"touch_gap_cm", "cm",
     "Distance between the surfaces of the robot's thumb and finger while the human's touch. Mean "
     "and 95th percentile of its absolute value.",
     kOwn},
    {"dynamics_bad_pct", "%",
     "Share of the time in which contacts cannot supply the required forces: an unexplained force "
     "above a tenth of the weight or an unexplained horizontal torque above 3 cm x weight; lengths "
     "are for a G1 and scale with the legs for other robots.",
     kDynamics},
    {"unexplained_force_pct", "%",
     "Required force that no contact can supply, relative to the weight. Mean and 95th percentile.",
     kDynamics},
    {"unexplained_torque_cm", "cm",
     "Required horizontal torque about the centre of mass that no contact can supply, divided by "
     "the weight. Mean and 95th percentile.",
     kDynamics},
    {"torque_over_pct", "%",
     "Share of the time in which a joint needs more torque than its limit, with the contact forces "
     "that require the least torque.",
     kDynamics},
    {"torque_p99_ratio", "1", "99th percentile of the largest ratio of a torque to its limit.",
     kDynamics},
    {"zmp_margin_p5_cm", "cm",
     "Distance of the zero-moment point inside the support polygon; negative outside. 5th "
     "percentile over the time in which the contacts carry at least a fifth of the weight.",
     kDynamics},
    {"friction_p95", "1",
     "Required friction of all contact forces: ratio of the horizontal to the vertical component "
     "of their sum; 95th percentile over the same time.",
     kDynamics},
    {"flight_force_pct", "%",
     "Mean unexplained force while no body is near the floor: the deviation of the centre of mass "
     "from free fall.",
     kDynamics},
    {"flight_torque_cm", "cm",
     "Mean rate of the angular momentum, divided by the weight, over the same time; 0 in free "
     "fall.",
     kDynamics},
    {"tracked_pct", "%",
     "Share of the motion before the robot of the simulation falls; 100 if it does not fall.",
     kCertificate, true},
    {"predicted_tracking_success", "1",
     "Predicted probability that the controller of the simulation tracks the motion without a "
     "fall.",
     kCertificate, true},
});

// A group contains the metrics from this key up to the next group's key. New metrics next to
// similar ones therefore need no entry.
struct GroupStart {
  std::string_view key;
  MetricGroup group;
};
constexpr auto kGroupStarts = std::to_array<GroupStart>({
    {"solver_failures", MetricGroup::kLimits},
    {"peak_speed", MetricGroup::kSmoothness},
    {"foot_pen_1cm_pct", MetricGroup::kFloor},
    {"flat_slip_p50", MetricGroup::kFeet},
    {"self_1cm_pct", MetricGroup::kCollisions},
    {"float_planted_pct", MetricGroup::kFloor},
    {"lying_pct", MetricGroup::kFeet},
    {"support_pct", MetricGroup::kFloor},
    {"scene_pen_1cm_pct", MetricGroup::kScene},
    {"flights", MetricGroup::kFeet},
    {"track_pos_cm", MetricGroup::kSimilarity},
    {"dynamics_bad_pct", MetricGroup::kDynamics},
});

constexpr auto kHeadlines = std::to_array<std::string_view>(
    {"limit_pct", "joint_at_limit_pct", "joint_beyond_range_pct", "peak_speed", "jumps", "acc_p99",
     "root_jerk_mean", "flat_slip_p95", "stance_slip_mean", "foot_pen_max_cm", "self_max_cm",
     "scene_pen_max_cm", "limb_angle_deg", "worst_limb_angle_deg", "trunk_lean_error_deg",
     "finger_angle_deg", "touch_gap_cm", "dynamics_bad_pct", "torque_over_pct"});

}  // namespace

bool needs_dynamics(const Metric& metric) {
  return metric.source == kDynamics;
}

std::string_view group_name(MetricGroup group) {
  constexpr std::array<std::string_view, kMetricGroups.size()> kNames = {
      "limits", "smoothness", "feet", "floor", "collisions", "scene", "similarity", "dynamics"};
  return kNames[static_cast<std::size_t>(group)];
}

MetricGroup group_of(const Metric& metric) {
  MetricGroup group = kGroupStarts.front().group;
  for (const Metric& each : kMetrics) {
    const auto start = std::ranges::find(kGroupStarts, each.key, &GroupStart::key);
    if (start != kGroupStarts.end()) group = start->group;
    if (each.key == metric.key) break;
  }
  return group;
}

bool is_headline(const Metric& metric) {
  return std::ranges::find(kHeadlines, metric.key) != kHeadlines.end();
}

std::span<const Metric> quality_metrics() {
  return kMetrics;
}

const Metric* find_metric(std::string_view key) {
  const auto found = std::ranges::find(kMetrics, key, &Metric::key);
  return found == kMetrics.end() ? nullptr : &*found;
}

std::vector<std::string> metric_keys() {
  std::vector<std::string> keys;
  keys.reserve(kMetrics.size());
  for (const Metric& metric : kMetrics) keys.emplace_back(metric.key);
  return keys;
}

}  // namespace retarget
