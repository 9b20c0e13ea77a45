#include "view/page.h"

#include <algorithm>
#include <array>
#include <utility>

namespace retarget {
namespace {

// In the order of quality_metrics().
constexpr auto kMetricLabels = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"solver_failures", "Solver failures"},
    {"limit_pct", "Beyond joint limits"},
    {"limit_max_rad", "Beyond joint limits, largest"},
    {"at_limit_pct", "At a joint limit"},
    {"joint_at_limit_pct", "Joint most often at its limit"},
    {"joint_beyond_range_pct", "Pose demands more than a joint's range"},
    {"joint_frames_at_limit_pct", "Joints at limits, all frames"},
    {"speed_limit_pct", "Above joint speed limits"},
    {"speed_limit_max_ratio", "Joint speed relative to its limit, largest"},
    {"peak_speed", "Joint speed, largest"},
    {"fast_3pi_pct", "Joints faster than 3 pi rad/s"},
    {"jumps", "Joint jumps"},
    {"jump_frames", "Frames with joint jumps"},
    {"max_step_rad", "Joint step, largest"},
    {"acc_rms", "Joint acceleration, RMS"},
    {"acc_p99", "Joint acceleration, 99th percentile"},
    {"root_jerk_mean", "Root jerk"},
    {"root_jerk_p99", "Root jerk, 99th percentile"},
    {"root_acc_p99", "Root acceleration, 99th percentile"},
    {"root_acc_max", "Root acceleration, maximum"},
    {"com_acc_rms", "Centre of mass acceleration, RMS"},
    {"com_acc_p99", "Centre of mass acceleration, 99th percentile"},
    {"root_jumps", "Root jumps"},
    {"foot_pen_1cm_pct", "Sole penetration"},
    {"foot_pen_max_cm", "Sole penetration, deepest"},
    {"body_pen_1cm_pct", "Floor penetration"},
    {"body_pen_max_cm", "Floor penetration, deepest"},
    {"float_2cm_pct", "Above the floor, including flights"},
    {"sole_height_p50_cm", "Sole height, median"},
    {"flat_slip_p50", "Flat sole slip, median"},
    {"flat_slip_p95", "Flat sole slip, 95th percentile"},
    {"self_1cm_pct", "Self-collision"},
    {"self_max_cm", "Self-collision, deepest"},
    {"self_all_1cm_pct", "Self-collision, every frame"},
    {"self_all_max_cm", "Self-collision, every frame, deepest"},
    {"float_planted_pct", "Floating in contact"},
    {"hover_pct", "Hovering"},
    {"lying_pct", "Source lies or crawls"},
    {"source_slide_mean", "Source slides"},
    {"contact_pct", "Source feet in contact"},
    {"contact_slip_mean", "Contact slip"},
    {"contact_slip_p95", "Contact slip, 95th percentile"},
    {"contact_drift_p95_cm", "Contact drift, 95th percentile"},
    {"contact_height_p50_cm", "Contact height, median"},
    {"contact_agreement_pct", "Contacts agree with the source"},
    {"contact_kept_pct", "Contacts preserved"},
    {"stance_pct", "Source feet flat in contact"},
    {"stance_slip_mean", "Stance slip"},
    {"stance_drift_p95_cm", "Stance drift, 95th percentile"},
    {"stance_height_p50_cm", "Stance height, median"},
    {"support_pct", "Other body parts on the floor"},
    {"support_slip_mean", "Slip of other body parts"},
    {"support_drift_p95_cm", "Drift of other body parts, 95th percentile"},
    {"support_height_p50_cm", "Height of other body parts, median"},
    {"support_height_p95_cm", "Height of other body parts, 95th percentile"},
    {"scene_pen_1cm_pct", "Scene penetration"},
    {"scene_pen_max_cm", "Scene penetration, deepest"},
    {"scene_contact_pct", "Contacts with the scene"},
    {"scene_contact_kept_pct", "Contacts with the scene preserved"},
    {"scene_gap_p95_cm", "Gap to the scene in contact, 95th percentile"},
    {"scene_contact_precision_pct", "Contacts with the scene, precision"},
    {"scene_contact_recall_pct", "Contacts with the scene, recall"},
    {"scene_slip_mean", "Slip on the scene"},
    {"flights", "Flights of the source"},
    {"flight_peak_max_cm", "Flight height error, largest"},
    {"track_pos_cm", "Body position error"},
    {"track_rot_deg", "Body rotation error"},
    {"limb_angle_deg", "Limb angle error"},
    {"worst_limb_angle_deg", "Limb angle error, worst limb"},
    {"arm_jolts", "Arm jolts"},
    {"trunk_lean_error_deg", "Trunk lean error"},
    {"root_slide_mean", "Root path drift speed"},
    {"root_bounce_pct", "Root bounce preserved"},
    {"lag_s", "Delay"},
    {"fast_arm_pct", "Speed of fast arms preserved"},
    {"fast_leg_pct", "Speed of fast legs preserved"},
    {"joint_offset_rad", "Constant joint offset"},
    {"finger_angle_deg", "Finger angle error"},
    {"driven_finger_angle_deg", "Finger angle error, moving fingers"},
    {"touch_gap_cm", "Gap of touching fingers"},
    {"dynamics_bad_pct", "Time without sufficient contacts"},
    {"unexplained_force_pct", "Unexplained force"},
    {"unexplained_torque_cm", "Unexplained torque"},
    {"torque_over_pct", "Above torque limits"},
    {"torque_p99_ratio", "Torque relative to its limit, 99th percentile"},
    {"zmp_margin_p5_cm", "Balance margin, 5th percentile"},
    {"friction_p95", "Required friction, 95th percentile"},
    {"flight_force_pct", "Unexplained force in flight"},
    {"flight_torque_cm", "Unexplained torque in flight"},
    {"tracked_pct", "Tracked in the simulation"},
    {"predicted_tracking_success", "Predicted probability of tracking"},
});

}  // namespace

std::string_view metric_label(std::string_view key) {
  const auto* found =
      std::ranges::find(kMetricLabels, key, &std::pair<std::string_view, std::string_view>::first);
  return found == kMetricLabels.end() ? key : found->second;
}

}  // namespace retarget
