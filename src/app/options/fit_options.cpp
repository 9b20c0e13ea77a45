#include "retarget/option_table.h"

#include "app/options/options_json.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kMaxWeight = 1e6;
constexpr double kAbove0 = 1e-9;

Option term(const char* name, bool& on, const char* help) {
  return option(name, on, {.group = "Terms", .help = help});
}

Option number(const char* group, const char* name, double& value, const char* help,
              double min = 0.0, double max = kMaxWeight) {
  return option(name, value, {.group = group, .help = help, .min = min, .max = max});
}

Option count(const char* name, int& value, const char* help, int min, int max) {
  return option(name, value,
                {.group = "Solver", .help = help, .min = double(min), .max = double(max)});
}

OptionTable term_table(FitOptions& o) {
  return {
      term("tracking", o.tracking, "Bodies track their targets"),
      term("foot-height", o.foot_height, "Heel and toe follow the source's clearance"),
      term("contact", o.contact, "Heels and toes in contact do not move and stay on the floor"),
      term("floor", o.floor, "No part of the robot penetrates the floor"),
      term("self-collision", o.self_collision, "Parts of the robot do not penetrate each other"),
      term("smoothness", o.smoothness, "Velocities change slowly"),
      term("speed", o.speed, "Joints stay below soft_joint_speed"),
      term("dynamics", o.dynamics, "Contacts can supply the forces that the motion requires")};
}

OptionTable weight_table(TrackingWeights& w) {
  constexpr const char* kGroup = "Tracking, per metre or radian";
  return {
      number(kGroup, "hips_position", w.hips_position, "Pelvis position"),
      number(kGroup, "hips_rotation", w.hips_rotation, "Pelvis orientation"),
      number(kGroup, "torso_rotation", w.torso_rotation, "Torso orientation"),
      number(kGroup, "thigh_position", w.thigh_position, "Hip joints"),
      number(kGroup, "shank_position", w.shank_position, "Knees"),
      number(kGroup, "thigh_rotation", w.thigh_rotation, "Directions of the thighs"),
      number(kGroup, "thigh_twist", w.thigh_twist, "Rotations of the thighs about their length"),
      number(kGroup, "shank_rotation", w.shank_rotation, "Directions of the shanks"),
      number(kGroup, "shank_twist", w.shank_twist, "Rotations of the shanks about their length"),
      number(kGroup, "foot_position", w.foot_position,
             "Ankles: horizontal position, and height while the foot is in the air"),
      number(kGroup, "foot_rotation", w.foot_rotation, "Feet"),
      number(kGroup, "upper_arm_position", w.upper_arm_position, "Shoulders"),
      number(kGroup, "upper_arm_rotation", w.upper_arm_rotation, "Upper arms"),
      number(kGroup, "straight_upper_arm_twist", w.straight_upper_arm_twist,
             "Share of the weight about the upper arm's length while the elbow is straight", 0.0,
             1.0),
      number(kGroup, "forearm_position", w.forearm_position, "Elbows"),
      number(kGroup, "forearm_rotation", w.forearm_rotation, "Forearms"),
      number(kGroup, "hand_position", w.hand_position, "Wrists"),
      number(kGroup, "hand_rotation", w.hand_rotation, "Hands"),
      number(kGroup, "other_position", w.other_position, "All other bodies of the configuration"),
      number(kGroup, "other_rotation", w.other_rotation, "All other bodies of the configuration")};
}

OptionTable foot_table(FitOptions& o) {
  constexpr const char* kGroup = "Feet, floor and body";
  return {
      number(kGroup, "foot_height_near", o.foot_height_near,
             "Clearance of a foot near the floor, per metre"),
      number(kGroup, "foot_height_far", o.foot_height_far,
             "Clearance of a foot at foot_height_range above the floor, per metre"),
      number(kGroup, "foot_height_range", o.foot_height_range, "Metres", kAbove0),
      number(kGroup, "foot_height_below", o.foot_height_below,
             "Factor for these weights while a foot is below its clearance"),
      number(kGroup, "contact_weight", o.contact_weight,
             "Distance of a heel or toe in contact from its contact position, per metre"),
      number(kGroup, "contact_height_weight", o.contact_height_weight,
             "Height above the floor of a heel or toe in contact, per metre"),
      number(kGroup, "body_contact_weight", o.body_contact_weight,
             "Distance of a knee, elbow, hand, seat or back in contact from its contact position, "
             "per metre"),
      number(kGroup, "body_contact_height_weight", o.body_contact_height_weight,
             "Height above the floor of a knee, elbow, hand, seat or back in contact, per metre"),
      number(kGroup, "sole_floor_weight", o.sole_floor_weight,
             "Depth of sole points below sole_margin, per metre"),
      number(kGroup, "sole_margin", o.sole_margin, "Metres; applies to feet without contact", -1.0,
             1.0),
      number(kGroup, "body_floor_weight", o.body_floor_weight,
             "Depth of other bodies below body_margin, per metre"),
      number(kGroup, "body_margin", o.body_margin, "Metres", -1.0, 1.0),
      number(kGroup, "scene_contact_weight", o.scene_contact_weight,
             "Distance of a body in contact from its surface of the scene, per metre"),
      number(kGroup, "scene_place_weight", o.scene_place_weight,
             "Distance of this body from the human's contact position on the surface, per metre"),
      number(kGroup, "scene_hold_weight", o.scene_hold_weight,
             "Distance of this body from its own mean position on the surface, per metre"),
      number(kGroup, "scene_palm_weight", o.scene_palm_weight,
             "Direction of the hand side that faces a held object, per radian"),
      number(kGroup, "scene_margin", o.scene_margin,
             "Metres; bodies stay this far from surfaces of the scene", -1.0, 1.0),
      number(kGroup, "self_collision_weight", o.self_collision_weight,
             "Overlap of two shapes, per metre"),
      number(kGroup, "self_collision_margin", o.self_collision_margin,
             "Metres; shapes closer than this count as overlapping", -1.0, 1.0),
      number(kGroup, "limit_margin_weight", o.limit_margin_weight,
             "Depth of a joint in the last 3 % of its range, as a share of them; cubic cost")};
}

OptionTable motion_table(FitOptions& o) {
  constexpr const char* kGroup = "Smoothness and speed";
  return {
      number(kGroup, "smoothness_leg", o.smoothness_leg,
             "Legs and waist, per rad/s of deviation from the smoothed velocity"),
      number(kGroup, "smoothness_arm", o.smoothness_arm, "Arms, per rad/s"),
      number(kGroup, "smoothness_wrist", o.smoothness_wrist, "Wrists, per rad/s"),
      number(kGroup, "smoothness_root_position", o.smoothness_root_position,
             "Root, per m/s of deviation from the smoothed velocity, relative to the reference"),
      number(kGroup, "smoothness_root_reference", o.smoothness_root_reference,
             "Share of the low-passed target's accelerations that are not penalised in the root",
             0.0, 1.0),
      number(kGroup, "smoothness_root_rotation", o.smoothness_root_rotation, "Root, per rad/s"),
      number(kGroup, "smoothing_time", o.smoothing_time,
             "Seconds; velocities are smoothed over about this time", 0.0, 10.0),
      number(
          kGroup, "limb_smoothing_time", o.limb_smoothing_time,
          "Seconds; the same for arms and legs out of contact, where the cost penalises changes of "
          "acceleration; 0: as for other joints",
          0.0, 10.0),
      number(kGroup, "soft_joint_speed", o.soft_joint_speed, "rad/s; faster joints are slowed down",
             kAbove0),
      number(kGroup, "speed_weight", o.speed_weight, "Per rad/s above soft_joint_speed"),
      number(kGroup, "max_joint_speed", o.max_joint_speed,
             "rad/s; upper bound for all joints, in addition to their own limits", kAbove0),
      number(kGroup, "max_joint_step", o.max_joint_step,
             "rad; largest joint step between two frames", kAbove0)};
}

OptionTable dynamics_table(FitOptions& o) {
  constexpr const char* kGroup = "Dynamics, for the size and mass of a G1";
  return {
      number(kGroup, "com_weight", o.com_weight,
             "Distance of the centre of mass from its target, per metre"),
      number(kGroup, "spin_weight", o.spin_weight,
             "Angular momentum, as the rotation that it produces, per kg m^2"),
      number(kGroup, "support_friction", o.support_friction,
             "Friction coefficient for planning contact forces", 0.0, 10.0),
      number(kGroup, "sole_shrink", o.sole_shrink, "Fraction by which soles are shrunk", 0.0, 1.0)};
}

OptionTable contact_table(FitOptions& o) {
  constexpr const char* kGroup =
      "Contact detection in the source, for a body with legs 0.85 m long";
  return {number(kGroup, "contact_speed", o.contact_speed,
                 "m/s; a slower heel or toe may be in contact"),
          number(kGroup, "contact_release_speed", o.contact_release_speed,
                 "m/s; a contact ends above this speed"),
          number(kGroup, "contact_height", o.contact_height,
                 "Metres above its standing height; a lower heel or toe may be in contact"),
          number(kGroup, "contact_release_height", o.contact_release_height,
                 "Metres; a contact ends above this height"),
          number(kGroup, "contact_time", o.contact_time,
                 "Seconds; minimum duration of a contact; 0: one frame"),
          number(kGroup, "support_time", o.support_time,
                 "Seconds; a raised foot that is slow for this long stands on something"),
          number(kGroup, "support_drift", o.support_drift,
                 "Metres; the foot may move this far in that time")};
}

OptionTable solver_table(FitOptions& o) {
  OptionTable table = {
      number("Solver", "window", o.window,
             "Length of the windows into which a clip is cut, seconds", 0.1),
      number("Solver", "seam", o.seam,
             "Time on either side of a window boundary that is solved again, seconds"),
      count("iterations", o.iterations, "Gauss-Newton steps", 0, 10000),
      count("extra_iterations", o.extra_iterations,
            "Maximum number of further steps while a window has not converged; with dynamics, "
            "before them "
            "and again after them",
            0, 10000),
      count("anchor_iterations", o.anchor_iterations,
            "Number of these steps that also move the contact positions", 0, 10000),
      count("dynamics_iterations", o.dynamics_iterations,
            "Number of final steps that include the dynamics", 0, 10000),
      count("threads", o.threads,
            "Number of threads; 0: one per processor. The result does not depend on it", 0, 1024),
      count("decimals", o.decimals,
            "Decimal digits at which printed numbers still satisfy the limits", 3, 17)};
  return table;
}

}  // namespace

OptionTable fit_table(FitOptions& options) {
  OptionTable table = term_table(options);
  append(table, weight_table(options.weights));
  append(table, foot_table(options));
  append(table, motion_table(options));
  append(table, dynamics_table(options));
  append(table, contact_table(options));
  append(table, solver_table(options));
  return table;
}

Result<FitOptions> parse_fit_options(std::string_view text, const std::string& file,
                                     FitOptions options) {
  TRY_ASSIGN(const auto json, parse_json(text, file));
  TRY(read_options(json, fit_table(options), file, "the options of the fit"));
  return options;
}

Result<void> set_terms(FitOptions& options, std::span<const std::string> names, bool on) {
  const OptionTable terms = term_table(options);
  for (const std::string& name : names) {
    const Option* row = find_option(terms, name);
    if (row == nullptr) {
      const std::vector<std::string> known = option_names(terms);
      return usage_failure("the fit has no term \"" + name + "\"" + did_you_mean(name, known),
                           "its terms are " + list_names(known));
    }
    TRY(row->set(on));
  }
  return {};
}

}  // namespace retarget
