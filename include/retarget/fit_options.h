#pragma once

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Weights that pull the robot's bodies to the bones assigned by a retargeting configuration. They
/// multiply residuals, so they enter the cost of a frame squared. Rows of the configuration without
/// a weight stay unweighted.
struct TrackingWeights {
  double hips_position = 29.0;  ///< Weight per metre.
  double hips_rotation = 16.0;  ///< Weight per radian.
  double torso_rotation = 16.0;
  double thigh_position = 0.0;
  double thigh_rotation = 14.0;  ///< Weight of the bone's direction.
  double thigh_twist = 6.0;  ///< Weight of the rotation about the bone. Hips with offsets cannot
                             ///< follow twist and foot direction together.
  double shank_position = 10.0;
  double shank_rotation = 13.0;  ///< Weight of the bone's direction.
  double shank_twist = 5.0;      ///< Weight of the rotation about the bone.
  double foot_position = 30.0;   ///< Weight of the horizontal position; for a foot off the ground
                                 ///< also the vertical.
  double foot_rotation = 16.0;
  double upper_arm_position = 5.0;
  double upper_arm_rotation = 48.0;
  double straight_upper_arm_twist = 0.2;  ///< Share of the weight about the bone while the elbow is
                                          ///< straight: there the twist does not move the forearm.
  double forearm_position = 10.0;
  double forearm_rotation = 8.0;
  double hand_position = 10.0;
  double hand_rotation = 8.0;
  double other_position = 10.0;  ///< All other bodies of the configuration.
  double other_rotation = 8.0;
};

/// Options of the fit (docs/fit.md). The defaults work for all clips and robots. Lengths are in
/// metres and times in seconds, so that the result does not depend on the frame rate.
struct FitOptions {
  // Terms; each can be disabled by name.
  bool tracking = true;        ///< Bodies follow their targets.
  bool foot_height = true;     ///< Heels and toes follow the source's clearance.
  bool contact = true;         ///< Heels and toes in contact neither slip nor leave the floor.
  bool floor = true;           ///< No body penetrates the floor.
  bool self_collision = true;  ///< Bodies of the robot do not penetrate each other.
  bool smoothness = true;      ///< Velocities change slowly.
  bool speed = true;           ///< Joints stay below `soft_joint_speed`.
  bool dynamics = true;        ///< Contact forces can produce the motion.

  TrackingWeights weights;

  double foot_height_near = 80.0;  ///< Weight of the clearance of a foot near the floor, per metre.
  double foot_height_far = 40.0;   ///< Weight of the clearance of a foot `foot_height_range` above
                                   ///< the floor, per metre.
  double foot_height_range = 0.12;  ///< Metres.
  double foot_height_below = 1.8;   ///< Factor for these weights while a foot is below its
                                    ///< clearance.

  /// Weight of the distance from heel or toe to its anchor, per metre.
  double contact_weight = 1000.0;
  /// Weight of the height of a heel or toe in contact above its surface, per metre.
  double contact_height_weight = 400.0;
  /// Weight of the distance from a knee, elbow, hand, seat or back in contact to its anchor, per
  /// metre.
  double body_contact_weight = 500.0;
  /// Weight of the height of these bodies above the floor, per metre.
  double body_contact_height_weight = 280.0;

  double sole_floor_weight = 400.0;  ///< Weight of the depth of sole points below sole_margin, per
                                     ///< metre.
  double sole_margin = 0.002;        ///< Clearance below which a swing foot is penalised, metres.
  /// Weight of the depth of other bodies below body_margin, per metre.
  double body_floor_weight = 800.0;
  double body_margin = 0.006;  ///< Clearance below which other bodies are penalised, metres.

  /// Weight of the distance from a body in contact to its surface of the scene, per metre.
  double scene_contact_weight = 230.0;
  /// Weight of the distance from this body to the human's contact position, per metre.
  double scene_place_weight = 12.0;
  /// Weight of the distance from this body to its own mean position on the surface, per metre.
  double scene_hold_weight = 150.0;
  /// Weight of the direction in which a hand faces a held object, per radian.
  double scene_palm_weight = 10.0;
  double scene_margin = 0.004;  ///< Clearance from other bodies of the scene below which links are
                                ///< penalised, metres.

  double self_collision_weight = 600.0;  ///< Weight of the overlap of two shapes, per metre.
  double self_collision_margin = 0.008;  ///< Distance below which two shapes are penalised, metres.

  /// Weight of the depth inside the margin before a joint limit (3 % of the range), relative to the
  /// margin. The cost grows with the cube of the depth.
  double limit_margin_weight = 5.0;

  /// Weight of the deviation of legs and waist from their smoothed velocity, per rad/s. Multiplied
  /// by smoothing_time, it is approximately a weight of accelerations, per rad/s^2.
  double smoothness_leg = 1.75;
  double smoothness_arm = 2.15;    ///< Like smoothness_leg, for arms.
  double smoothness_wrist = 1.65;  ///< Like smoothness_leg, for wrists.
  /// Like smoothness_leg, for the root's position, per m/s; see smoothness_root_reference.
  double smoothness_root_position = 72.0;
  /// Share of the low-passed target's accelerations that are not penalised in the root.
  double smoothness_root_reference = 1.0;
  double smoothness_root_rotation = 4.0;  ///< Like smoothness_leg, for the root's rotation.
  double smoothing_time = 0.013;  ///< Approximate time constant of the velocity smoothing, seconds.
  /// Time constant for arms and legs out of contact, seconds. There, the cost penalises changes of
  /// acceleration, so that limbs may reverse as fast as the human's. 0: as for other joints.
  double limb_smoothing_time = 0.019;

  // Options of `dynamics`, for the size and mass of a G1.
  /// Weight of the distance from the centre of mass to its planned position, per metre.
  double com_weight = 1400.0;
  double spin_weight = 280.0;     ///< Weight of the angular quasi-coordinate's error, per kg m^2.
  int dynamics_iterations = 6;    ///< Number of final solver steps that include dynamics.
  double support_friction = 0.6;  ///< Friction coefficient of the planned contact forces.
  double sole_shrink = 0.15;      ///< Share by which contact points move to the middle of a sole.

  double soft_joint_speed = 9.0;  ///< Soft speed limit, rad/s.
  double speed_weight = 16.0;     ///< Weight of a speed above soft_joint_speed, per rad/s.
  double max_joint_speed = 14.4;  ///< Hard speed limit in addition to the joint's own, rad/s.
  double max_joint_step = 0.48;   ///< Hard limit of the change between two frames, rad.

  // Contact detection in the source. Lengths and speeds are for a body with legs (thigh and shank)
  // 0.85 m long.
  double contact_speed = 0.15;          ///< Speed below which a contact may begin, m/s.
  double contact_release_speed = 0.25;  ///< Speed above which a contact ends, m/s.
  /// Distances from the standing height within which a contact begins and beyond which it ends,
  /// metres.
  double contact_height = 0.04;
  double contact_release_height = 0.06;
  double contact_time = 0.1;  ///< Shortest contact, seconds.
  // Conditions for a raised stance of a foot, as on a box.
  double support_time = 0.15;   ///< Time during which the foot is slow, seconds.
  double support_drift = 0.02;  ///< Largest displacement in this time, metres.

  // Solver.
  int iterations = 10;  ///< Gauss-Newton steps.
  /// Maximum additional steps while a window has not converged; with dynamics, before them and again
  /// after them.
  int extra_iterations = 10;
  int anchor_iterations = 7;  ///< Number of first steps that also move the anchors of contacts.
  double window = 20.0;       ///< Length of a window, seconds.
  double seam = 1.5;  ///< Seconds on either side of a window boundary that are solved again.
  int threads = 0;    ///< Number of threads; 0: all cores. It does not affect the result.
  int decimals = 6;   ///< Decimals of the output, for which limits hold after rounding.
};

}  // namespace retarget
