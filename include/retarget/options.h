#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

// All options of a program. Defaults are those of the command line; option names, ranges and
// meanings are in docs/options.md, generated from the same tables (src/options).

namespace RETARGET_API retarget {

/// How a robot's motion is made.
enum class Method : unsigned char {
  kFit,  ///< All frames of the clip at once, to be followable by a robot (docs/fit.md).
  kGmr,  ///< The published two-pass inverse kinematics, frame by frame (docs/ik.md).
};

/// Which implementation of the inverse kinematics runs; both take the same steps.
enum class IkEngine : unsigned char { kFast, kReference };

/// What happens to leading frames that the motion jumps away from (a T-pose, an all-zero frame).
enum class LeadIn : unsigned char {
  kAuto,  ///< Dropped, except with Method::kGmr.
  kDrop,
  kKeep,
};

/// Between two frames of a clip.
enum class Interpolation : unsigned char {
  kLinear,  ///< Positions linear, rotations slerp.
  kCubic,   ///< Through all frames with continuous velocity: Catmull-Rom, of rotations
            ///< Shoemake's spherical form.
};

/// Files that hold a robot's motion; docs/formats.md describes each.
enum class MotionFormat : unsigned char {
  kCsv,             ///< Unitree's layout: root, quaternion, joints; SI.
  kCsvSoma,         ///< SOMA and BONES-SEED: header, frame number, centimetres, degrees, Euler.
  kNpzMjlab,        ///< Tracking arrays in MuJoCo's order of joints and bodies.
  kNpzBeyondMimic,  ///< Tracking arrays in Isaac Lab's order.
  kPklGmr,          ///< GMR's dictionary.
  kPklPbhc,         ///< PBHC's and ASAP's dictionary of dictionaries.
  kGlb,             ///< glTF 2.0, binary: a picture that moves, for Blender and web pages.
  kNpzHolosoma,     ///< Tracking arrays with the root among the joints, for holosoma.
  kPklMotionLib,    ///< SONIC's motion library: as kPklPbhc, with all joints.
  kPklMimicKit,     ///< MimicKit's frames: root, rotation vector, joints.
  kProtoMotions,    ///< ProtoMotions' `.motion`, a file of PyTorch.
  kCsvSonic,        ///< SONIC's reference motion: a folder of CSVs.
};

/// Order of the four quaternion columns.
enum class QuaternionOrder { kXyzw, kWxyz };

/// The point whose velocity `body_lin_vel_w` is.
enum class BodyPoint : unsigned char {
  kLink,  ///< The link's origin, as mjlab has it.
  kMass,  ///< The centre of mass of the link and what is fixed to it, as Isaac Lab has it.
};

/// How the body's size scales a human to a robot.
enum class ScaleRule : unsigned char {
  kTable,   ///< As in the published method: by the configuration's table, in proportion to the
            ///< height, which it assumes to be 1.75 m for everyone.
  kHeight,  ///< By the table, but inversely to the height: every body is brought to the size of the
            ///< published one first, so that a child and a giant moving alike give the same motion.
  kLimbs,   ///< Not by the table: legs, trunk and arms take the robot's lengths.
};

/// What a robot's fingers do (docs/hands.md).
enum class HandsRule : unsigned char {
  kAuto,     ///< As kFollow, but kOff with Method::kGmr.
  kFollow,   ///< What the human's do; relaxed where the source has none, or none that move.
  kRelaxed,  ///< Half open, as those of a hand that does nothing.
  kOff,      ///< They stay where the body's solver leaves them.
};

/// One of the six directions of a file's axes.
struct SignedAxis {
  int axis = 1;           ///< 0, 1 or 2 for x, y or z.
  bool negative = false;  ///< Against the axis.

  [[nodiscard]] Eigen::Vector3d direction() const {
    return (negative ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis);
  }
  friend bool operator==(const SignedAxis&, const SignedAxis&) = default;
};

/// `+x`, `-z`.
[[nodiscard]] std::string to_text(const SignedAxis& axis);

/// Which pose of the source is brought to the canonical T-pose.
enum class RestPose {
  kAuto,     ///< The zero pose when it is a well-formed T-, A- or I-pose; else a frame that is a
             ///< T-pose within a few degrees; else kLearned.
  kZero,     ///< All rotations zero.
  kFirst,    ///< The first frame.
  kFrame,    ///< CalibrationOptions::rest_frame.
  kBest,     ///< The frame most like a T-pose.
  kLearned,  ///< None: axes from bone directions, elbow and knee hinges, upright and flat-footed
             ///< frames of the whole movement.
};

/// How strongly the robot's bodies are pulled to the bones that a retargeting configuration assigns
/// to them. Weights of residuals: they enter the cost squared, per frame. Rows of the configuration
/// without a weight stay unweighted.
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
  double other_position = 10.0;  ///< Whatever else a retargeting configuration has.
  double other_rotation = 8.0;
};

/// Options of the fit. One setting works for all clips and robots; lengths are in metres, times in
/// seconds, so that nothing depends on the frame rate (docs/fit.md).
struct FitOptions {
  // terms; each can be left out by name
  bool tracking = true;        ///< Bodies follow their targets.
  bool foot_height = true;     ///< Heel and toe follow the source's clearance.
  bool contact = true;         ///< Heels and toes in contact stay where they are, on the floor.
  bool floor = true;           ///< Nothing goes below the floor.
  bool self_collision = true;  ///< Parts of the robot do not penetrate each other.
  bool smoothness = true;      ///< Velocities change slowly.
  bool speed = true;           ///< Joints stay below `soft_joint_speed`.
  bool dynamics = false;       ///< Contacts can supply what the movement needs.

  TrackingWeights weights;

  double foot_height_near = 80.0;   ///< Weight of the clearance of a foot near the floor, per m.
  double foot_height_far = 40.0;    ///< The same `foot_height_range` above the floor.
  double foot_height_range = 0.12;  ///< Metres.

  double contact_weight = 900.0;         ///< Heel or toe in contact to its place, per metre.
  double contact_height_weight = 400.0;  ///< The same to the floor.
  /// Knee, elbow, hand, seat or back in contact to its place, per metre.
  double body_contact_weight = 300.0;
  double body_contact_height_weight = 120.0;  ///< The same to the floor.

  double sole_floor_weight = 400.0;  ///< Sole points below `sole_margin`, per metre.
  double sole_margin = 0.002;        ///< Metres; for feet that are not in contact.
  double body_floor_weight = 800.0;  ///< Other bodies below `body_margin`, per metre.
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

  // of `dynamics`, with the size and mass of a G1
  double com_weight = 600.0;      ///< Centre of mass to its place, per metre.
  double spin_weight = 200.0;     ///< Angular momentum, as the turn that it makes, per kg m^2.
  int dynamics_iterations = 6;    ///< Of the solver's last steps, how many look at it.
  double support_friction = 0.6;  ///< That contacts are planned with.
  double sole_shrink = 0.15;      ///< By which share of its size a sole is taken smaller.

  double soft_joint_speed = 8.4;  ///< rad/s; faster joints are slowed down.
  double speed_weight = 6.5;      ///< Per rad/s above it.
  double max_joint_speed = 14.4;  ///< rad/s; no joint is ever faster, whatever its own limit.
  double max_joint_step = 0.48;   ///< rad; no joint ever moves farther between two frames.

  // when a source foot is in contact; lengths and speeds are those of a body with legs (thigh and
  // shank) 0.85 m long
  double contact_speed = 0.15;          ///< m/s; a slower heel or toe may be in contact.
  double contact_release_speed = 0.25;  ///< m/s; a contact lasts below.
  double contact_height = 0.04;         ///< Metres above its standing height.
  double contact_release_height = 0.06;
  double contact_time = 0.1;  ///< Seconds; anything shorter is not a contact.
  // a raised foot stands on something when it is this still
  double support_time = 0.15;   ///< Seconds that it must be slow.
  double support_drift = 0.02;  ///< Metres that it may move in that time.

  // solver
  int iterations = 10;        ///< Gauss-Newton steps.
  int extra_iterations = 10;  ///< As many more while a window has not converged.
  int anchor_iterations = 7;  ///< Of these, how many also move the places of contacts.
  double window = 20.0;       ///< Seconds that are solved together.
  double seam = 1.5;          ///< Seconds on either side of a window's end that are solved again.
  int threads = 0;            ///< 0: all of the machine's. The result does not depend on it.
  int decimals = 6;           ///< Digits at which limits hold for the numbers as printed.
};

/// What the file of a robot's motion does not say; what is not given is found in it.
struct MotionFileOptions {
  std::optional<MotionFormat> from;  ///< Format in place of what the content says.
  std::optional<QuaternionOrder> quaternion;
  std::string angles;  ///< `rad`, `deg`.
  std::string unit;    ///< `m`, `cm`, `mm`.
  std::string dof;     ///< Variant of the robot that the columns are of.
  bool ignore_header = false;
};

/// How a motion file is read.
struct SourceOptions {
  bool smpl = false;        ///< Read as SMPL or SMPL-X whatever the content; else detected.
  std::string smpl_model;   ///< The user's body model, NPZ; empty: a generic body.
  bool lenient = false;     ///< Keep the complete frames of a damaged file.
  std::string root;         ///< Which of several ROOTs, or of several skeletons of a scene.
  std::string take;         ///< Which of several motions in a file, by name or number from 1.
  std::string joint_names;  ///< List of joints' names, for places of joints; empty: not given.
  std::string
      from_robot;  ///< The robot whose motion the file has, by name or folder; empty: a human's.
  MotionFileOptions robot_file;  ///< Of a robot's motion.
  double source_fps = 0.0;  ///< Frames per second; 0: the file's own. A scene is sampled so often.
  double memory_gb = 0.0;   ///< Limit for one clip; 0: three quarters of what is available.
};

/// How the human in a clip is recognised and measured; what is not given is detected.
struct HumanOptions {
  std::string map;       ///< Bone map (which joint is which bone) instead of recognition.
  bool partial = false;  ///< Arms or legs may be missing.
  RestPose rest = RestPose::kAuto;
  int tpose_frame = -1;    ///< Frame of the source that is the T-pose; negative: not given.
  std::string tpose_file;  ///< BVH of the same skeleton whose first frame is the T-pose.
  std::string unit;        ///< `m`, `dm`, `cm`, `mm`, `inch`, `cmu`, or metres; empty: detected.
  std::optional<SignedAxis> up, forward;  ///< In the file's axes.
  double height = 0.0;                    ///< Metres; 0: estimated.
  bool unit_optional = false;             ///< The unit is not needed.
};

/// Which part of a clip is used.
struct PartOptions {
  double start_s = -1.0;  ///< Negative: not given.
  double end_s = -1.0;    ///< Inclusive.
  std::string frames;     ///< `a:b` as in Python slices; empty: not given.
  LeadIn lead_in = LeadIn::kAuto;
};

/// Whether a robot's base moves.
enum class RobotBase : unsigned char {
  kAuto,   ///< As the robot's profile says; without, it moves.
  kFixed,  ///< It stands fast: an upper body on a stand or on wheels, or a robot that is held.
};

/// A robot by its name or folder, or by its model file.
struct RobotChoice {
  std::string name;     ///< `unitree_g1`, `g1`, a folder with model.xml and robot.json.
  std::string model;    ///< Instead of a name: MJCF or URDF.
  std::string profile;  ///< For `model`: robot.json; empty: none.
  std::string variant;  ///< Whose other joints are held: `29`, `23`; empty: the whole robot.
  RobotBase base = RobotBase::kAuto;
};

/// How a motion is solved.
struct SolveOptions {
  std::string limits;     ///< A set of the robot, or a JSON or MJCF file; empty: the method's own.
  std::string ik_config;  ///< `published`, `derived`, or a file; empty: whichever suits the source.
  Method method = Method::kFit;
  std::string fit_config;            ///< JSON of FitOptions, overrides `fit`; empty: none.
  FitOptions fit;                    ///< Of Method::kFit.
  double fit_window_s = 0.0;         ///< Overrides FitOptions::window; 0: does not.
  std::vector<std::string> with;     ///< Terms of the fit that it does not have by default.
  std::vector<std::string> without;  ///< Terms of the fit to leave out.
  IkEngine engine = IkEngine::kFast;
  HandsRule hands = HandsRule::kAuto;
  std::optional<ScaleRule>
      scale;  ///< Empty: kLimbs; kTable for LAFAN1 with the published method or
              ///< a retargeting configuration made for it.
};

/// The output's frames.
struct TimeOptions {
  std::optional<double> fps = 30.0;  ///< Empty: the source's own rate.
  Interpolation interpolation = Interpolation::kCubic;
  bool no_antialias = false;  ///< Do not low-pass a source that is faster than the output.
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
  bool normalize_start = false;           ///< Begin at x = y = 0, facing +x.
  int npz_fps = 50;                       ///< NPZ: frames per second.
  std::optional<BodyPoint> npz_velocity;  ///< NPZ; empty: the format's own.
  std::string motion_name;                ///< In PBHC's files; empty: from the output's name.
  std::string contacts;  ///< CSV of when the feet are planted, beside the output; empty: none.
};

/// Everything that a motion depends on besides its clip and its robot.
struct Options {
  SourceOptions source;
  HumanOptions human;
  PartOptions part;
  SolveOptions solve;
  TimeOptions time;
  SaveOptions save;
};

/// A run from file to file, as recorded in a sidecar and repeated by `verify`.
struct Run {
  std::string motion;  ///< The clip's file; `-`: standard input.
  RobotChoice robot;
  Options options;
  std::string output;  ///< `-`: standard output.
};

}  // namespace retarget
