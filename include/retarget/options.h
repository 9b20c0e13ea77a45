#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/fit_options.h"

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
