#include "retarget/report.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {
namespace {

constexpr std::string_view kOwn = "own";
constexpr std::string_view kNotes = "measurements of the published G1 data";
constexpr std::string_view kHolosoma = "holosoma evaluation, 1 cm";
constexpr std::string_view kContacts = "contacts of the source foot: contact_plan.h";
constexpr std::string_view kDynamics = "inverse dynamics: docs/dynamics.md";

// steps are between consecutive frames, speeds are steps times the rate
constexpr auto kMetrics = std::to_array<Metric>({
    {"limit_pct", "%", "Frames with a joint beyond its limits by more than 1e-6 rad or m.", kOwn},
    {"limit_max_rad", "rad", "Largest amount by which a joint is beyond its limits; 0 within.",
     kOwn},
    {"at_limit_pct", "%",
     "Frames with a joint within 0.01 rad, or a hundredth of its range where that is less, of a "
     "limit, or beyond it; heads, hands, and limits reached in the zero configuration, excluded.",
     kOwn},
    {"joint_at_limit_pct", "%",
     "The same of the joint and limit with the most frames; `at_limit` names them.", kOwn},
    {"joint_frames_at_limit_pct", "%",
     "Of all joints that count in all frames: those at a limit, by the rules of at_limit_pct.",
     kOwn},
    {"speed_limit_pct", "%",
     "Steps in which a joint is faster than its speed limit (by more than 1e-6 rad per step).",
     kNotes},
    {"speed_limit_max_ratio", "1", "Largest ratio of a joint's speed to its limit.", kNotes},
    {"peak_speed", "rad/s", "Largest speed of a joint.", kNotes},
    {"fast_3pi_pct", "%", "Steps in which a joint is faster than 3 pi rad/s.",
     "nominal joint speed of the published method"},
    {"jumps", "count", "Steps of single joints over 0.5 rad.", kNotes},
    {"jump_frames", "count", "Steps between frames in which some joint moves more than 0.5 rad.",
     kNotes},
    {"max_step_rad", "rad", "Largest step of a joint.", kOwn},
    {"acc_rms", "rad/s^2", "Root mean square of all joints' accelerations (second differences).",
     kNotes},
    {"acc_p99", "rad/s^2",
     "99th percentile over frames of the largest joint acceleration in a frame.", kNotes},
    {"root_jerk_mean", "m/s^3", "Mean length of the root position's third difference.",
     "PHUMA, under 50"},
    {"root_jerk_p99", "m/s^3", "Its 99th percentile.", "PHUMA"},
    {"root_acc_p99", "m/s^2",
     "99th percentile over frames of the root's acceleration, of the cubic spline through its "
     "positions.",
     kOwn},
    {"com_acc_rms", "m/s^2",
     "Root mean square acceleration of the centre of mass over frames, of the cubic spline through "
     "its positions.",
     kOwn},
    {"com_acc_p99", "m/s^2", "Its 99th percentile.", kOwn},
    {"root_jumps", "count",
     "Steps in which the root is faster than 10 m/s or turns faster than 20 rad/s; gymnasts and "
     "dancers of LAFAN1 stay below 5 and 13.",
     kOwn},
    {"foot_pen_1cm_pct", "%", "Frames with a sole point more than 1 cm below the floor.",
     kHolosoma},
    {"foot_pen_max_cm", "cm", "Depth of the deepest sole point; negative: its smallest height.",
     kHolosoma},
    {"body_pen_1cm_pct", "%",
     "Frames with a sole point or collision primitive more than 1 cm below the floor.", kHolosoma},
    {"body_pen_max_cm", "cm", "Depth of the deepest of them; negative: their smallest height.",
     kHolosoma},
    {"float_2cm_pct", "%",
     "Frames with every sole point and primitive more than 2 cm above the floor, flight included.",
     kNotes},
    {"sole_height_p50_cm", "cm", "Median over frames of the lowest sole point's height.", kNotes},
    {"flat_slip_p50", "m/s",
     "Median horizontal speed of the middle of a sole whose points are all under 2 cm at both ends "
     "of the step.",
     kNotes},
    {"flat_slip_p95", "m/s", "Its 95th percentile.", kNotes},
    {"self_1cm_pct", "%",
     "Of every fifth frame: those with primitives of two bodies deeper than 1 cm in each other, by "
     "MuJoCo's contact depth, allowed pairs excluded.",
     kOwn},
    {"self_max_cm", "cm", "Depth of the deepest of these contacts; 0 without.", kOwn},
    {"self_all_1cm_pct", "%",
     "The same for every frame, by exact depth: the shortest translation that separates the two.",
     kOwn},
    {"self_all_max_cm", "cm", "Depth of the deepest of these.", kOwn},
    {"float_planted_pct", "%",
     "Frames in which a source foot is in contact and every sole point and primitive is more than "
     "2 cm above the floor.",
     kContacts},
    {"lying_pct", "%",
     "Frames in which the source lies or crawls: its trunk leans by more than 60 degrees, and its "
     "hips are lower than three quarters of its legs.",
     kOwn},
    {"contact_pct", "%", "Feet and frames in which the source foot is in contact.", kContacts},
    {"contact_slip_mean", "m/s",
     "Mean horizontal speed of the middle of the sole while the source foot is in contact.",
     "GMD foot skating, with contacts from the source as in OmniRetarget"},
    {"contact_slip_p95", "m/s", "Its 95th percentile.", kOwn},
    {"contact_drift_p95_cm", "cm",
     "Largest horizontal distance of the middle of the sole from its median place within a "
     "contact; 95th percentile over contacts.",
     kOwn},
    {"contact_height_p50_cm", "cm",
     "Median height of the lowest sole point while the source foot is in contact.", kOwn},
    {"contact_agreement_pct", "%",
     "Feet and frames in which source and robot agree on whether the foot stands: the robot's does "
     "while its lowest sole point is under 2 cm and the middle of its sole slower than 0.25 m/s.",
     "PHUMA and OmniRetarget, contact preservation"},
    {"contact_kept_pct", "%",
     "Of those in which the source foot is in contact: the robot's stands.",
     "OmniRetarget, contact preservation"},
    {"stance_pct", "%",
     "Feet and frames in which the source foot is in contact on its sole: the direction that is up "
     "when it stands at most 41 degrees from the vertical.",
     kContacts},
    {"stance_slip_mean", "m/s", "contact_slip_mean of these.", kOwn},
    {"stance_drift_p95_cm", "cm", "contact_drift_p95_cm of these.", kOwn},
    {"stance_height_p50_cm", "cm", "contact_height_p50_cm of these.", kOwn},
    {"support_pct", "%",
     "Knees, elbows, hands, seat and back of the source that lie on the floor, together, by "
     "frames.",
     kOwn},
    {"support_slip_mean", "m/s",
     "Mean horizontal speed of the robot's body there while the source's lies on the floor; 0: "
     "none does.",
     kOwn},
    {"support_drift_p95_cm", "cm",
     "Largest horizontal distance of it from its median place within such a contact; 95th "
     "percentile "
     "over contacts.",
     kOwn},
    {"support_height_p50_cm", "cm", "Median height of its lowest primitive meanwhile.", kOwn},
    {"support_height_p95_cm", "cm", "Its 95th percentile.", kOwn},
    {"flights", "count",
     "Flights of the source: no toe or ankle near its standing height for 0.1 s while the hips "
     "rise and fall as in free fall.",
     kContacts},
    {"flight_peak_max_cm", "cm",
     "Largest difference, over flights, of the robot's peak sole height (of the lowest sole point) "
     "from the source's peak clearance of the lower foot, scaled.",
     kOwn},
    {"track_pos_cm", "cm",
     "Distance of bodies from the scaled bones that they follow, both from the root, a constant "
     "yaw "
     "removed: rows of table 2 with position weight, the root excluded. Mean and 95th percentile.",
     "MPJPE, root-relative"},
    {"track_rot_deg", "deg",
     "Angle of bodies from the offset axes of the bones that they follow (limb by limb: from the "
     "axes that a fit "
     "aims them at): rows of table 2 with rotation weight. Mean and 95th percentile.",
     kOwn},
    {"limb_angle_deg", "deg",
     "Angle between the robot's limbs (from joint to joint, a constant yaw removed) and the "
     "human's: "
     "thighs, shins, upper arms, forearms, trunk, hip and shoulder line. Mean and 95th percentile.",
     kOwn},
    {"worst_limb_angle_deg", "deg", "The same of the limb with the largest mean.", kOwn},
    {"trunk_lean_error_deg", "deg",
     "Difference between the robot's lean and the human's: angle from the vertical of the line "
     "from hips to shoulders, each from its own standing pose. Mean and 95th percentile.",
     kOwn},
    {"finger_angle_deg", "deg",
     "Angle between the parts of the robot's fingers and the human's, at the same shares of their "
     "lengths, both seen from the palm; thumbs excluded. Mean and 95th percentile.",
     kOwn},
    {"touch_gap_cm", "cm",
     "Distance between the skins of the robot's thumb and finger while the human's touch; amount, "
     "mean and 95th percentile.",
     kOwn},
    {"dynamics_bad_pct", "%",
     "Share of the time in which contacts cannot supply what the movement needs: more than a tenth "
     "of the weight or a torque across the vertical of more than 3 cm x weight is unexplained; "
     "lengths are those of a G1, in proportion to the legs for other robots.",
     kDynamics},
    {"unexplained_force_pct", "%",
     "Force, in terms of the weight, that no contact supplies. Mean and 95th percentile.",
     kDynamics},
    {"unexplained_torque_cm", "cm",
     "Torque about the centre of mass and across the vertical, divided by the weight, that no "
     "contact supplies. Mean and 95th percentile.",
     kDynamics},
    {"torque_over_pct", "%",
     "Share of the time in which a joint needs more torque than its limit, with the contact forces "
     "that need least.",
     kDynamics},
    {"torque_p99_ratio", "1", "99th percentile of the largest ratio of a torque to its limit.",
     kDynamics},
    {"zmp_margin_p5_cm", "cm",
     "How far inside the polygon of the points of support the zero-moment point is; negative "
     "outside. 5th percentile over the time in which they hold a fifth of the weight.",
     kDynamics},
    {"friction_p95", "1",
     "Friction that the contact forces need together: horizontal by vertical part of their sum; "
     "95th percentile over the same time.",
     kDynamics},
    {"flight_force_pct", "%",
     "Mean unexplained force while nothing is near the floor: how far the centre of mass is from "
     "free fall.",
     kDynamics},
    {"flight_torque_cm", "cm",
     "Mean rate of the angular momentum, divided by the weight, in the same time; 0 in free fall.",
     kDynamics},
});

}  // namespace

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
