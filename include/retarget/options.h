#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

// All options. The defaults match the command line. docs/options.md, generated from the same
// tables (src/app/options), lists option names, ranges and meanings.

namespace RETARGET_API retarget {

/// Retargeting method.
enum class Method : unsigned char {
  kFit,  ///< Optimises the whole clip for feasibility (docs/fit.md).
  kGmr,  ///< Published two-pass inverse kinematics, frame by frame (docs/ik.md).
};

/// Inverse kinematics engine; both engines produce the same iterates.
enum class IkEngine : unsigned char { kFast, kReference };

/// Treatment of the lead-in: leading frames before a jump (a T-pose, an all-zero frame).
enum class LeadIn : unsigned char {
  kAuto,  ///< Drops the lead-in, except with Method::kGmr.
  kDrop,
  kKeep,
};

/// Treatment of noise in a clip: jittering joints, a drifting root, lost joints, frozen frames.
enum class CleanRule : unsigned char {
  kAuto,  ///< Removes measured noise, except with Method::kGmr; clean clips remain unchanged.
  kOff,   ///< Uses the clip unchanged.
};

/// Interpolation between two frames of a clip.
enum class Interpolation : unsigned char {
  kLinear,  ///< Linear positions, slerp rotations.
  kCubic,   ///< Catmull-Rom, through all frames with continuous velocity; rotations use
            ///< Shoemake's spherical form.
};

/// File formats for robot motions; see docs/formats.md.
enum class MotionFormat : unsigned char {
  kCsv,       ///< Unitree's layout: root position, quaternion, joints; SI units.
  kCsvSoma,   ///< SOMA and BONES-SEED: header, frame number, centimetres, degrees, Euler angles.
  kNpzMjlab,  ///< Tracking arrays in MuJoCo's order of joints and bodies.
  kNpzBeyondMimic,  ///< Tracking arrays in Isaac Lab's order.
  kPklGmr,          ///< GMR's dictionary.
  kPklPbhc,         ///< PBHC's and ASAP's dictionary of dictionaries.
  kGlb,             ///< Binary glTF 2.0: an animation for Blender and web pages.
  kNpzHolosoma,     ///< Tracking arrays with the root among the joints, for holosoma.
  kPklMotionLib,    ///< SONIC's motion library: kPklPbhc with all joints.
  kPklMimicKit,     ///< MimicKit's frames: root, rotation vector, joints.
  kProtoMotions,    ///< ProtoMotions' `.motion`, a PyTorch file.
  kCsvSonic,        ///< SONIC's reference motion: a folder of CSVs.
};

/// Order of the four quaternion columns.
enum class QuaternionOrder { kXyzw, kWxyz };

/// The point to which the velocity `body_lin_vel_w` refers.
enum class BodyPoint : unsigned char {
  kLink,  ///< The link's origin, as in mjlab.
  kMass,  ///< The centre of mass of the link with the bodies fixed to it, as in Isaac Lab.
};

/// How a human is scaled to a robot.
enum class ScaleRule : unsigned char {
  kTable,   ///< Published method: the configuration's scale table, in proportion to the body
            ///< height, which it assumes to be 1.75 m for everyone.
  kHeight,  ///< The table, in inverse proportion to the body height. Every body is first scaled to
            ///< the published size, so that bodies of any height give the same robot motion.
  kLimbs,   ///< Without the table: legs, trunk and arms get the robot's lengths.
};

/// Motion of the robot's fingers (docs/hands.md).
enum class HandsRule : unsigned char {
  kAuto,     ///< Follow fingers that move or close, else kRelaxed; kOff with Method::kGmr.
  kFollow,   ///< Follow the human's fingers; relaxed if they keep the rest pose.
  kRelaxed,  ///< Half open, like an idle hand.
  kOff,      ///< Keep the joint positions of the body solver.
};

/// One of the six signed coordinate axes of a file.
struct SignedAxis {
  int axis = 1;           ///< 0, 1 or 2 for x, y or z.
  bool negative = false;  ///< Points against the axis.

  [[nodiscard]] Eigen::Vector3d direction() const {
    return (negative ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis);
  }
  friend bool operator==(const SignedAxis&, const SignedAxis&) = default;
};

/// `+x`, `-z`.
[[nodiscard]] std::string to_text(const SignedAxis& axis);

/// Pose of the source that corresponds to the canonical T-pose.
enum class RestPose {
  kAuto,     ///< The zero pose if it is a well-formed T-, A- or I-pose; else a frame within a few
             ///< degrees of a T-pose; else kLearned.
  kZero,     ///< All rotations zero.
  kFirst,    ///< The first frame.
  kFrame,    ///< CalibrationOptions::rest_frame.
  kBest,     ///< The frame closest to a T-pose.
  kLearned,  ///< No pose: axes are estimated from bone directions, elbow and knee hinges, and the
             ///< upright and flat-footed frames of the whole clip.
};

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

/// Properties of a robot motion file. Unset values are detected.
struct MotionFileOptions {
  std::optional<MotionFormat> from;  ///< Format; overrides detection by content.
  std::optional<QuaternionOrder> quaternion;
  std::string angles;  ///< `rad`, `deg`.
  std::string unit;    ///< `m`, `cm`, `mm`.
  std::string dof;     ///< Variant of the robot whose joints the columns hold.
  bool ignore_header = false;
};

/// How a motion file is read.
struct SourceOptions {
  bool smpl = false;        ///< Read as SMPL or SMPL-X; false: detect by content.
  std::string smpl_model;   ///< Body model file (NPZ) of the user; empty: a generic body.
  bool lenient = false;     ///< Keep the complete frames of a damaged file.
  std::string root;         ///< Selects one of several ROOTs, or of several skeletons of a scene.
  std::string take;         ///< Selects one of several motions, by name or by number from 1.
  std::string joint_names;  ///< Joint names for files of joint positions; empty: not given.
  /// Robot (name or folder) whose motion the file contains; empty: human motion.
  std::string from_robot;
  MotionFileOptions robot_file;  ///< Options of a robot motion file.
  double source_fps = 0.0;       ///< Frame rate, 1/s; 0: the file's own. Scenes are sampled at it.
  double memory_gb = 0.0;  ///< Memory limit of one clip; 0: three quarters of the free memory.
};

/// How the human in a clip is recognised and measured. Unset values are detected.
struct HumanOptions {
  std::string map;       ///< Bone map (joint of each bone); replaces recognition.
  bool partial = false;  ///< Accept missing arms or legs.
  RestPose rest = RestPose::kAuto;
  int tpose_frame = -1;    ///< Source frame that holds the T-pose; negative: not given.
  std::string tpose_file;  ///< BVH of the same skeleton whose first frame is the T-pose.
  std::string unit;        ///< `m`, `dm`, `cm`, `mm`, `inch`, `cmu`, or metres; empty: detected.
  /// Unit vector in the file's axes: along an axis, or near one for a world that is not level.
  std::optional<Eigen::Vector3d> up;
  std::optional<SignedAxis> forward;  ///< Facing direction of the rest pose, in the file's axes.
  double height = 0.0;                ///< Metres; 0: estimated.
  bool unit_optional = false;         ///< Accept an unknown unit.
  CleanRule clean = CleanRule::kAuto;
};

/// Selected part of a clip.
struct PartOptions {
  double start_s = -1.0;  ///< Start time, seconds; negative: not given.
  double end_s = -1.0;    ///< End time, seconds, inclusive; negative: not given.
  std::string frames;     ///< `a:b` as in Python slices; empty: not given.
  LeadIn lead_in = LeadIn::kAuto;
};

/// Type of a robot's base.
enum class RobotBase : unsigned char {
  kAuto,   ///< Type given in the robot's profile; floating without a profile.
  kFixed,  ///< Fixed base: an upper body on a stand or a wheeled platform, or a suspended robot.
};

/// Part of a robot that follows the human.
enum class Follow : unsigned char {
  kAll,  ///< Base, legs, trunk and arms.
  /// Arms only, relative to the human's chest. The base is fixed; the joints of legs, trunk and
  /// head keep the standing pose, for another controller.
  kArms,
};

/// Selects a robot by name, folder or model file.
struct RobotChoice {
  std::string name;     ///< `unitree_g1`, `g1`, or a folder with model.xml and robot.json.
  std::string model;    ///< MJCF or URDF file, instead of a name.
  std::string profile;  ///< robot.json for `model`; empty: none.
  std::string variant;  ///< `29`, `23`: holds the other joints; empty: the whole robot.
  RobotBase base = RobotBase::kAuto;
  Follow follow = Follow::kAll;
};

/// Purpose of a motion. The preset of a purpose sets several options; explicit options override it.
enum class Purpose : unsigned char {
  kTracking,  ///< Training a policy that tracks the motion (docs/fit.md, "Motions for policies").
};

/// Unit and axes of a scene and of its tracks.
enum class SceneAxes : unsigned char {
  kHuman,  ///< Metres, Z up: the world of the canonical human.
  kClip,   ///< Those of the clip's file.
};

/// The paths of the moving bodies of a scene around a robot.
enum class ObjectMotion : unsigned char {
  kGiven,   ///< Their tracks, scaled.
  kFitted,  ///< Their scaled tracks, displaced with the parts of the robot that hold them.
};

/// How a motion is solved.
struct SolveOptions {
  std::optional<Purpose> purpose;  ///< Empty: no preset.
  /// Factor for the path over the ground of hips and planted feet, or `auto`: by speed. Empty: that
  /// of the preset, else 1.
  std::string travel;
  /// `auto`: slow down where the motion exceeds limits; or a factor from 0.25 to 1. Empty: 1.
  std::string time_scale;
  std::string limits;     ///< Limit set of the robot, or a JSON or MJCF file; empty: by method.
  std::string ik_config;  ///< `published`, `derived`, or a file; empty: chosen for the source.
  Method method = Method::kFit;
  std::string fit_config;  ///< JSON file of FitOptions; overrides `fit`; empty: none.
  FitOptions fit;          ///< Options of Method::kFit.
  /// Names (fit_table) of options of `fit` given explicitly. A preset overrides neither these nor
  /// options that differ from their defaults.
  std::vector<std::string> fit_given;
  double fit_window_s = 0.0;  ///< Overrides FitOptions::window, seconds; 0: no override.
  std::string scene;          ///< File of the scene around the human; empty: only a floor.
  /// Tracks of moving bodies of the scene: FILE or BODY=FILE.
  std::vector<std::string> object_tracks;
  SceneAxes scene_axes = SceneAxes::kHuman;
  /// Ground that is put under a clip recorded on a flat floor: `stairs:RISExTREAD`,
  /// `stairs:RISExTREADxCOUNT` (metres, in the robot's world) or `slope:DEGREES`; empty: none.
  std::string terrain;
  /// Factor for static bodies of the scene, about the origin: `S`, or `z=S` for heights only. The
  /// human's contacts follow. Empty: 1.
  std::string terrain_scale;
  /// Displacement of the moving bodies of the scene: `X,Y,Z`, metres. The hands that touch them
  /// follow. Empty: none.
  std::string object_shift;
  double object_scale = 1.0;  ///< Size of the moving bodies; the hands follow.
  ObjectMotion object_motion = ObjectMotion::kGiven;
  /// JSON file with edits of the detected contacts (contact_edits.h); empty: none.
  std::string contact_edits;
  std::vector<std::string> with;     ///< Terms of the fit to enable.
  std::vector<std::string> without;  ///< Terms of the fit to disable.
  IkEngine engine = IkEngine::kFast;
  HandsRule hands = HandsRule::kAuto;
  std::optional<ScaleRule>
      scale;  ///< Empty: kLimbs, but kTable for LAFAN1 with the published method or
              ///< with a retargeting configuration made for LAFAN1.
};

/// Timing of the output frames.
struct TimeOptions {
  std::optional<double> fps = 30.0;  ///< Frame rate, 1/s; empty: the source's own rate.
  Interpolation interpolation = Interpolation::kCubic;
  bool no_antialias = false;  ///< Disable the low-pass filter for downsampling.
};

/// Column separator of a CSV.
enum class Delimiter : unsigned char { kComma, kSpace, kTab };

/// How a motion is written (docs/formats.md).
struct SaveOptions {
  std::vector<MotionFormat> formats;  ///< Empty: by the output's extension.
  int precision = 6;                  ///< CSV: digits after the decimal point, 0 to 17.
  Delimiter delimiter = Delimiter::kComma;
  bool header = false;  ///< CSV: header line with the column names.
  QuaternionOrder quaternion = QuaternionOrder::kXyzw;
  bool frame_column = false;              ///< CSV: leading column with frame numbers from 0.
  bool degrees = false;                   ///< CSV: joints in degrees.
  bool centimetres = false;               ///< CSV: root position in centimetres.
  bool normalize_start = false;           ///< Start at x = y = 0, facing +x.
  int npz_fps = 50;                       ///< NPZ: frames per second.
  std::optional<BodyPoint> npz_velocity;  ///< NPZ: point of the body velocities; empty: by format.
  std::string motion_name;                ///< PBHC: name of the motion; empty: from the file name.
  std::string contacts;   ///< CSV file for contacts of the feet and, with a scene, of other parts;
                          ///< empty: none.
  std::string scene_out;  ///< File for the robot's scene; empty: none.
  /// Samples per second of a reference for controllers; 0: no reference.
  double reference_rate = 0.0;
  std::string reference;  ///< File of the reference, .npz or .csv; empty: beside the output.
};

/// All inputs of a motion other than the clip and the robot.
struct Options {
  SourceOptions source;
  HumanOptions human;
  PartOptions part;
  SolveOptions solve;
  TimeOptions time;
  SaveOptions save;
};

/// A run from an input file to an output file. A sidecar records it and `verify` repeats it.
struct Run {
  std::string motion;  ///< Input clip; `-`: standard input.
  RobotChoice robot;
  Options options;
  std::string output;  ///< Output file; `-`: standard output.
};

}  // namespace retarget
