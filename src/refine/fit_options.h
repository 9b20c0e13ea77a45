#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// How hard the robot's bodies are drawn to the bones that a mapping gives them. Weights of
/// residuals: they enter the cost squared, per frame. Rows of the mapping without a weight stay
/// without one.
struct TrackingWeights {
  double hips_position = 29.0;  ///< Per metre.
  double hips_rotation = 16.0;  ///< Per radian.
  double torso_rotation = 16.0;
  double thigh_position = 0.0;
  double thigh_rotation = 8.0;
  double shank_position = 10.0;
  double shank_rotation = 8.0;
  double foot_position = 30.0;  ///< Horizontally, and in height for a foot that does not stand.
  double foot_rotation = 16.0;
  double upper_arm_position = 5.0;
  double upper_arm_rotation = 48.0;
  double forearm_position = 10.0;
  double forearm_rotation = 8.0;
  double hand_position = 10.0;
  double hand_rotation = 8.0;
  double other_position = 10.0;  ///< Whatever else a mapping has.
  double other_rotation = 8.0;
};

/// Everything that a fit can be told. One setting serves all clips and robots; lengths are metres,
/// times seconds, so that nothing depends on the frame rate (docs/fit.md).
struct FitOptions {
  // terms; each can be left out by name
  bool tracking = true;        ///< Bodies follow their targets.
  bool foot_height = true;     ///< Heel and toe follow the source's clearance.
  bool contact = true;         ///< Planted heels and toes stay where they are, on the floor.
  bool floor = true;           ///< Nothing goes below the floor.
  bool self_collision = true;  ///< Parts of the robot stay out of each other.
  bool smoothness = true;      ///< Velocities change slowly.
  bool speed = true;           ///< Joints stay below `speed_soft`.

  TrackingWeights weights;

  double foot_height_near = 80.0;   ///< Weight of the clearance of a foot near the floor, per m.
  double foot_height_far = 40.0;    ///< The same `foot_height_range` above the floor.
  double foot_height_range = 0.12;  ///< Metres.

  double contact_weight = 900.0;         ///< Planted heel or toe to its place, per metre.
  double contact_height_weight = 400.0;  ///< The same to the floor.

  double sole_floor_weight = 400.0;  ///< Sole points below `sole_margin`, per metre.
  double sole_margin = 0.002;        ///< Metres; of feet that are not planted.
  double body_floor_weight = 400.0;  ///< Other bodies below `body_margin`, per metre.
  double body_margin = 0.006;        ///< Metres.

  double self_collision_weight = 450.0;  ///< Overlap of two shapes, per metre.
  double self_collision_margin = 0.008;  ///< Metres; nearer counts as overlap.

  double smoothness_leg = 1.75;  ///< Legs and waist, per rad/s of deviation from the smoothed
                                 ///< velocity: times smoothing_time, per rad/s^2.
  double smoothness_arm = 2.15;
  double smoothness_wrist = 1.65;
  double smoothness_root_position = 20.0;  ///< Per m/s.
  double smoothness_root_rotation = 4.0;
  double smoothing_time = 0.013;  ///< Seconds; velocities are smoothed over about this time.

  double speed_soft = 8.4;     ///< rad/s; faster joints are slowed down.
  double speed_weight = 6.5;   ///< Per rad/s above it.
  double speed_most = 14.4;    ///< rad/s; no joint is ever faster, whatever its own limit.
  double largest_step = 0.48;  ///< rad; no joint ever moves farther from a frame to the next.

  // when a source foot is planted; lengths and speeds are those of a body with legs (thigh and
  // shank) 0.85 m long
  double contact_speed = 0.15;          ///< m/s; a slower heel or toe may be planted.
  double contact_release_speed = 0.25;  ///< m/s; a planted one stays so below.
  double contact_height = 0.04;         ///< Metres above its standing height.
  double contact_release_height = 0.06;
  double contact_time = 0.1;  ///< Seconds; what is shorter is no contact.
  // a foot above the floor stands on something when it is as still as that
  double support_time = 0.15;   ///< Seconds that it is slow, at least.
  double support_drift = 0.02;  ///< Metres that it moves in that time, at most.

  // solver
  int iterations = 10;        ///< Gauss-Newton steps.
  int anchor_iterations = 7;  ///< Of these, how many also move the places of contacts.
  double window = 20.0;       ///< Seconds that are solved together.
  double seam = 1.5;          ///< Seconds on either side of a window's end that are solved again.
  int threads = 0;            ///< 0: as many as the machine has. The result is the same.
  int decimals = 6;           ///< Digits at which limits hold for the numbers as printed.
};

/// Reads options from JSON: an object with the names of FitOptions' members, those of the weights
/// among them; what is left out keeps its value. Unknown names, wrong types and values out of range
/// are named all at once (kConfig), with the nearest name.
/// @param file  for messages.
[[nodiscard]] Result<FitOptions> parse_fit_options(std::string_view text, const std::string& file,
                                                   FitOptions options = {});

/// Names of the terms that can be left out.
[[nodiscard]] const std::vector<std::string>& fit_term_names();

/// Leaves terms out by name; a kUsage error suggests the nearest name.
[[nodiscard]] Result<void> leave_out_terms(FitOptions& options, std::span<const std::string> names);

}  // namespace retarget
