#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/robot.h"
#include "retarget/scene.h"
#include "retarget/solved_scene.h"

namespace RETARGET_API retarget {

/// Name of a format as on the command line: `csv`, `csv-soma`, `npz-mjlab`, ...
[[nodiscard]] std::string_view format_name(MotionFormat format);

/// File extension: `.csv`, `.npz`, `.pkl`, `.motion` or `.glb`; empty: the format is a folder.
[[nodiscard]] std::string_view format_ending(MotionFormat format);
/// Whether a motion in this format is a folder of files.
[[nodiscard]] bool format_is_folder(MotionFormat format);
/// Names of the files that a folder in this format may contain.
[[nodiscard]] std::vector<std::string> folder_file_names(MotionFormat format);
/// Whether files in this format use the rate TrackingOptions::rate instead of the motion's rate.
[[nodiscard]] bool format_has_own_rate(MotionFormat format);
/// Distinguishes files of one motion in several formats: `.csv`, `.soma.csv`, `.mjlab.npz`, ...
[[nodiscard]] std::string_view format_long_ending(MotionFormat format);

/// Layout of a robot CSV. The defaults match Unitree's published G1 data, which BeyondMimic, mjlab,
/// unitree_rl_lab and PBHC read.
struct RobotCsvOptions {
  int precision = 6;     ///< Digits after the decimal point, clamped to 0 to 17.
  char delimiter = ',';  ///< `,`, blank or tab.
  bool header = false;   ///< A header line with the column names.
  QuaternionOrder quaternion_order = QuaternionOrder::kXyzw;
  bool frame_column = false;  ///< A leading column with frame numbers from 0.
  int frame_step = 1;         ///< Increment of the frame numbers.
  bool degrees = false;       ///< Hinges in degrees.
  bool centimetres = false;   ///< Root position and slides in centimetres.
  /// The root's rotation as three angles about the fixed axes x, y, z, in that order (R = Rz Ry
  /// Rx), in the unit of the joints (degrees or radians), instead of a quaternion.
  bool euler = false;
};

/// Layout of SOMA and BONES-SEED: comma, header, frame column, centimetres, degrees, Euler angles.
/// Their readers assume 120 frames per second. If 120 is a multiple of the rate, frame numbers
/// therefore increase by 120 / rate (at 30 fps: 0, 4, 8, ...), else by one.
[[nodiscard]] RobotCsvOptions soma_csv_options(const FrameRate& rate, int precision = 6);

/// Whether the frame numbers of soma_csv_options encode this rate.
[[nodiscard]] bool soma_csv_tells(const FrameRate& rate);

/// Formats configurations as CSV lines: root position x y z (metres), root quaternion, then the
/// joint positions (radians, metres for slides) in the robot's output order. The options change
/// units and columns. Numbers are in fixed notation without negative zeros; lines end in LF. The
/// bytes do not depend on the locale.
///
/// The header names the columns `root_x`, `root_qx` and by joint name; with Euler angles, as in
/// SOMA: `Frame`, `root_translateX`, `root_rotateX`, and joint names followed by `_dof`.
class RobotCsvFormatter {
 public:
  explicit RobotCsvFormatter(const Robot& robot, const RobotCsvOptions& options = {});

  /// The header line, or empty.
  [[nodiscard]] const std::string& header() const { return header_; }

  /// Appends one line.
  /// @param qpos   configuration in the layout of RobotClip.
  /// @param text   output.
  /// @param frame  frame number for the frame column.
  void append_line(std::span<const double> qpos, std::string& text, int frame = 0) const;

 private:
  struct Column {
    int address;  // Index into a configuration.
    double factor;
  };
  void append_value(double value, std::string& text) const;

  RobotCsvOptions options_;
  std::vector<Column> position_, rotation_, joints_;  // Columns in output order.
  std::string header_;
};

/// Formats a whole clip as CSV.
[[nodiscard]] std::string format_robot_csv(const RobotClip& clip,
                                           const RobotCsvOptions& options = {});

/// The clip as read back from its CSV: numbers rounded as printed, in the units of the file, joints
/// without a column at the zero configuration, quaternions normalised and sign-continuous.
/// Errors (kRun): a quaternion that rounds to zero at this precision.
[[nodiscard]] Result<RobotClip> printed_clip(const RobotClip& clip,
                                             const RobotCsvOptions& options = {});

/// Names of the foot contacts, in storage order.
inline constexpr std::array<std::string_view, 4> kContactNames = {"left_heel", "left_toe",
                                                                  "right_heel", "right_toe"};

/// Planted heels and toes of a robot, per frame. They follow the contacts of the human's feet.
struct FootContacts {
  std::vector<std::uint8_t> planted;  ///< Frames x kContactNames; 1: planted.

  [[nodiscard]] int frame_count() const {
    return static_cast<int>(planted.size() / kContactNames.size());
  }
  /// Whether the heel or the toe of a foot is planted.
  /// @param foot  0 left, 1 right.
  [[nodiscard]] bool foot_planted(int frame, int foot) const {
    const std::size_t heel =
        kContactNames.size() * static_cast<std::size_t>(frame) + 2 * static_cast<std::size_t>(foot);
    return planted[heel] != 0 || planted[heel + 1] != 0;
  }
};

/// Resamples contacts to another rate by the nearest frame.
/// @param frames  number of frames of the result.
[[nodiscard]] FootContacts resample_contacts(const FootContacts& contacts, const FrameRate& from,
                                             const FrameRate& to, int frames);

/// Formats contacts as CSV: a header, then per frame its number, its time in seconds and 0 or 1 for
/// each of kContactNames.
/// @param labels  contacts in a scene; null: no scene. The columns of kContactNames are then
///     contacts with the floor, and a column `part:surface` follows for each part and surface that
///     touch.
[[nodiscard]] std::string format_contacts_csv(const FootContacts& contacts, const FrameRate& rate,
                                              const ContactLabels* labels = nullptr);

/// Order of joints and bodies in the arrays of a tracking file.
///
/// The bodies are the root and those moved by an output joint. A body fixed to another one, or held
/// by the robot's variant, is part of its parent, as in Isaac Lab's importer (mjlab's models have
/// no such bodies). kNpzBeyondMimic and kCsvSonic use Isaac Lab's breadth-first order: by depth in
/// the tree of these bodies, then MuJoCo's order. Other formats use MuJoCo's depth-first order.
struct TrackingLayout {
  std::vector<int> joints;  ///< Indices into Robot::joints().
  std::vector<int> bodies;  ///< Indices into Robot::bodies().
  int fixed = 0;            ///< kNpzHolosoma: the last `fixed` bodies are fixed to another body.
};

/// Layout of a format.
/// @param format  one with bodies: an NPZ format, kProtoMotions or kCsvSonic.
[[nodiscard]] TrackingLayout tracking_layout(const Robot& robot, MotionFormat format);

/// Options of make_tracking_motion.
struct TrackingOptions {
  FrameRate rate{50, 1};
  std::optional<BodyPoint> velocity_of;  ///< Empty: as in the format's training framework.
  /// Include a sample that coincides with the last frame; kProtoMotions and kCsvSonic always do.
  bool until_last = false;
};

/// Options for converting a motion: a file at the motion's own rate keeps all of its frames, so
/// that repeated conversions lose nothing.
/// @param motion  frame rate of the motion.
[[nodiscard]] TrackingOptions conversion_options(TrackingOptions options, const FrameRate& motion);

/// Frames of the file of a motion.
[[nodiscard]] int format_frame_count(const RobotClip& clip, MotionFormat format,
                                     const TrackingOptions& options = {});

/// The frames and numbers of a motion that its file holds: all except the last for an NPZ, rounded
/// to float32 if the format stores these. A motion that the file has at another rate is unchanged.
[[nodiscard]] RobotClip stored_clip(const RobotClip& clip, MotionFormat format,
                                    const TrackingOptions& options = {});

/// Moving objects of a TrackingMotion; arrays of frames x objects x 3 or 4.
struct TrackedObjects {
  std::vector<std::string> names;
  std::vector<double> pos, quat;
  std::vector<double> lin_vel, ang_vel;  ///< Velocities of the origins of the objects' frames.
};

/// Contacts of a TrackingMotion with surfaces, one column per body of the robot and surface.
struct TrackedContacts {
  std::vector<std::string> links, surfaces;
  std::vector<double> labels;  ///< Frames x columns: 1 in contact, falling to 0 in 0.15 s.
};

/// Training data of motion trackers: row-major arrays; world frame, Z up, SI units, quaternions
/// wxyz.
struct TrackingMotion {
  MotionFormat format = MotionFormat::kNpzMjlab;
  FrameRate rate;
  std::size_t frames = 0;
  std::vector<std::string> joint_names, body_names;
  std::vector<double> joint_pos, joint_vel;        ///< frames x joints.
  std::vector<double> body_pos, body_quat;         ///< frames x bodies x 3 and x 4.
  std::vector<double> body_lin_vel, body_ang_vel;  ///< frames x bodies x 3.
  std::vector<double> root_lin_vel;                ///< frames x 3, of the root body's origin.
  std::optional<FootContacts> contacts;            ///< One per sample; empty: unknown.
  std::optional<TrackedObjects> objects;           ///< Empty: only the robot moves.
  std::optional<TrackedContacts> touches;          ///< Empty: no scene.
};

/// Computes the arrays that csv_to_npz of BeyondMimic and mjlab get by replaying a CSV in a
/// simulator, from kinematics alone.
///
/// Samples are at 0, 1/rate, ... strictly before the last frame (see TrackingOptions::until_last).
/// Positions and joints are interpolated linearly, rotations by slerp. Velocities are central
/// differences of the samples, one-sided at the ends for positions and joints. The root's angular
/// velocity in the world frame is log(q[i+1] q[i-1]^-1) / (2 dt); its first and last values repeat
/// their neighbours. Body velocities follow from those of the root and the joints.
///
/// Errors (kInput): fewer than three samples, as angular velocities need three.
[[nodiscard]] Result<TrackingMotion> make_tracking_motion(const RobotClip& clip,
                                                          MotionFormat format,
                                                          const TrackingOptions& options = {});

/// Formats an NPZ file: `fps` (1,) int64, `joint_pos`, `joint_vel`, `body_pos_w`, `body_quat_w`,
/// `body_lin_vel_w`, `body_ang_vel_w` float32. Additional arrays, which training frameworks ignore:
/// `flavour`, joint names, body names and, if known, `contacts` (frames, 4) bool and
/// `contact_names`. With moving objects: `object_names`, `object_pos_w`, `object_quat_w`,
/// `object_lin_vel_w` and `object_ang_vel_w`. With a scene: `contact_labels` (frames, columns),
/// `contact_links` and `contact_surfaces`.
///
/// kNpzHolosoma: `joint_pos` starts with the root's position and quaternion wxyz, `joint_vel` with
/// its linear and angular velocity in the world frame. With moving objects also `qpos`: position
/// and quaternion wxyz of the root, joints, position and quaternion of each object. Errors (kRun):
/// a size of 4 GiB or more; a rate that is not an integer.
[[nodiscard]] Result<std::string> format_tracking_npz(const TrackingMotion& motion);

/// Colour of joints without their own colour, 0xRRGGBB.
inline constexpr int kPlainColour = 0x8A8A8A;

/// A human motion for display: any clip and its placement in a world with metres and Z up.
struct HumanInWorld {
  const Clip* clip = nullptr;  ///< Must outlive this object.
  double metres_per_unit = 0.01;
  Pose world_from_clip;      ///< Applied after scaling to metres.
  std::vector<int> colours;  ///< One per joint: colour of the bone that ends there, 0xRRGGBB. May
                             ///< have fewer entries than joints; the rest are kPlainColour.
};

/// Options of format_robot_motion.
struct WriteMotionOptions {
  RobotCsvOptions csv;       ///< Used by kCsv; kCsvSoma uses only its precision.
  TrackingOptions tracking;  ///< Used by the NPZ formats.
  std::string name;  ///< Name of the motion: the key in a kPklPbhc file, the animation in a kGlb
                     ///< file; empty: `motion`.
  std::optional<HumanInWorld> human = std::nullopt;  ///< Source motion, shown in a kGlb file.
  /// Contacts per frame of the clip, for formats that store them; empty: unknown.
  std::optional<FootContacts> contacts = std::nullopt;
  /// The robot's scene in the frames of the clip, and its contacts; for the NPZ formats.
  std::optional<SceneClip> scene = std::nullopt;
  std::optional<ContactLabels> labels = std::nullopt;
};

/// A formatted output file.
struct FormattedFile {
  std::string name;  ///< File name in the motion's folder; empty: the motion is a single file.
  std::string bytes;
};

/// Formats a motion as a single file.
///
/// kPklGmr: a dictionary of `fps`, `root_pos` (F, 3), `root_rot` (F, 4) xyzw and `dof_pos` (F, n),
/// float64, and `local_body_pos` (F, B, 3) float32: all bodies below the world with the root at the
/// origin and unrotated, named by `link_body_list`.
///
/// kPklPbhc: {name: {`root_trans_offset` (F, 3), `pose_aa` (F, 1 + n + 3, 3): rotation vectors of
/// the root and, about their axes, of the joints, then three zero rows, `dof` (F, n), `root_rot`
/// (F, 4) xyzw, `fps`}}, float32, and, if contacts are known, `contact_mask` (F, 2), left and
/// right. If the profile has a variant made for PBHC (its name ends in `pbhc`) and the robot is
/// complete, the variant's joints are used.
///
/// kPklMotionLib: the same with all joints of the robot, and `pose_aa` (F, 1 + n, 3).
///
/// kPklMimicKit: `loop_mode` 0, `fps`, `frames`: rows of root position, rotation vector, joints.
///
/// kProtoMotions: a PyTorch file with a dictionary: `state_conversion`, `fps`, `dof_pos`,
/// `dof_vel`, `rigid_body_pos`, `rigid_body_rot` xyzw, `rigid_body_vel`, `rigid_body_ang_vel`,
/// `rigid_body_contacts`.
///
/// kGlb: glTF 2.0 with one node per body and its shapes as meshes. Every frame has a rotation
/// (shortest-path quaternion) for each body moved by a hinge, and a translation for the root and
/// each body moved by a slide; interpolation is LINEAR. The scene is rotated to Y up. The human is
/// included as a skin. The format is for display only; no reader exists.
///
/// Errors: those of make_tracking_motion and format_tracking_npz; a GLB of 4 GiB or more (kRun); a
/// format that is a folder (kUsage).
[[nodiscard]] Result<std::string> format_robot_motion(const RobotClip& clip, MotionFormat format,
                                                      const WriteMotionOptions& options = {});

/// Formats a motion in any format, as one or more files. kCsvSonic: the files of SONIC's folder.
[[nodiscard]] Result<std::vector<FormattedFile>> format_motion_files(
    const RobotClip& clip, MotionFormat format, const WriteMotionOptions& options = {});

/// Formats only a human motion as a GLB; see kGlb.
[[nodiscard]] Result<std::string> format_human_glb(const HumanInWorld& human,
                                                   const std::string& name = {});

/// Converts a clip to another variant of its robot. Joints correspond by name; joints that the
/// variant locks have their locked positions.
[[nodiscard]] RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot);

/// The robot variant used in PBHC files; see format_robot_motion, kPklPbhc.
[[nodiscard]] Result<std::shared_ptr<const Robot>> pbhc_robot(
    const std::shared_ptr<const Robot>& robot);

/// Describes the joints that move in the clip but that a variant locks: their number, largest
/// motion and names; empty: none.
[[nodiscard]] std::optional<std::string> lost_joints(const RobotClip& clip, const Robot& variant);

/// Losses when a motion is stored in a format, one line each: PBHC's files have fewer joints,
/// readers of SOMA's and SONIC's files assume a rate.
/// @param rate  frame rate of the file.
[[nodiscard]] std::vector<std::string> format_losses(const RobotClip& motion, MotionFormat format,
                                                     const FrameRate& rate);

/// Properties that a motion file does not state or states wrongly. Empty: detected, or the format's
/// default.
struct ReadMotionOptions {
  std::optional<MotionFormat> format;     ///< Overrides detection by content.
  std::optional<FrameRate> rate;          ///< Overrides the file's rate.
  std::optional<FrameRate> default_rate;  ///< Rate of files that contain none; empty: 30, SOMA 120.
  std::optional<QuaternionOrder> quaternion;  ///< Root quaternion, for files without a header.
  /// Unit of hinges and root Euler angles in a CSV or a pickle; true: degrees, false: radians.
  std::optional<bool> degrees;
  std::optional<double>
      metres_per_unit;         ///< Unit of root position and slides in a CSV or a pickle.
  bool ignore_header = false;  ///< Reads CSV columns by position even with a header.
  std::string variant;         ///< Variant of the robot whose joints the columns hold.
  std::string motion;          ///< Selects one of several motions in a kPklPbhc file.
  /// Size limit of the file, and of the data of an NPZ array, bytes.
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
};

/// Result of reading a motion file.
struct RobotMotion {
  RobotClip clip;
  MotionFormat format = MotionFormat::kCsv;
  bool rate_known = false;               ///< The rate comes from the file or the options.
  std::vector<std::string> notes;        ///< Detected and guessed properties, human-readable; one
                                         ///< line each.
  std::vector<std::string> warnings;     ///< Human-readable; one line each.
  std::size_t bytes = 0;                 ///< Size of the file.
  std::optional<FootContacts> contacts;  ///< Contacts in the frames of the clip; empty: the file
                                         ///< has none.
};

/// Reads a robot motion in any format of docs/formats.md; the format is detected by content.
///
/// * CSV with a header: columns are found by name, ignoring letter case, quotes, a leading path and
///   trailing units. All names must be known and cover all joints of the robot or of one of its
///   variants. Without a header, columns are found by position: 7 for the root, then the joints of
///   the robot or of one of its variants; a leading column that counts up is allowed. Frame numbers
///   are ignored; times in s, ms, us or ns give the rate. SOMA's frame numbers count at 120 per
///   second, so steps of 4 mean 30 fps. SOMA and BONES-SEED files are recognised by their header.
/// * CSV units: values without a unit are radians and metres, as in files of retarget. In that
///   case, joint positions more than half a radian beyond the robot's widest range (joints without
///   a range: four turns) and a root higher than five times the reach of the robot's limbs are
///   errors; joints beyond their own ranges in most frames, and a root that is never near the
///   ground or too fast, give warnings.
/// * Order of the root quaternion: the order in which the robot stands upright, else the one in
///   which the lowest sole point slips less. If both fit equally (a robot standing still, facing
///   along x), the usual order xyzw is assumed; a body lying still is an error.
/// * Pickles of GMR, PBHC and ASAP, also written by joblib, compressed or not; see read_pickle for
///   the restrictions.
/// * Tracking NPZ: the order of joints and bodies is detected by forward kinematics. Values are in
///   radians and metres; unit options are errors.
///
/// Joints without a column stay at the zero configuration, joints that the robot's variant locks at
/// their locked position. Quaternions are normalised and made sign-continuous.
///
/// @param bytes  the whole file.
/// @param file   for messages.
/// @return kInput errors: malformed files; ambiguities, naming the option that resolves them.
[[nodiscard]] Result<RobotMotion> parse_robot_motion(std::string_view bytes,
                                                     const std::shared_ptr<const Robot>& robot,
                                                     const std::string& file,
                                                     const ReadMotionOptions& options = {});

/// Reads a file with parse_robot_motion; `-` reads standard input.
[[nodiscard]] Result<RobotMotion> load_robot_motion(const std::string& path,
                                                    const std::shared_ptr<const Robot>& robot,
                                                    const ReadMotionOptions& options = {});

}  // namespace retarget
