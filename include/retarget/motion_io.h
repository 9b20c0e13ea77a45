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

namespace RETARGET_API retarget {

/// As on the command line: `csv`, `csv-soma`, `npz-mjlab`, ...
[[nodiscard]] std::string_view format_name(MotionFormat format);
[[nodiscard]] std::vector<std::string> format_names();
/// Errors (kUsage): an unknown name (suggests the nearest one and lists all).
[[nodiscard]] Result<MotionFormat> format_from_name(std::string_view name);

/// `.csv`, `.npz`, `.pkl`, `.motion` or `.glb`; empty: a folder.
[[nodiscard]] std::string_view format_ending(MotionFormat format);
/// Whether a motion in this format is a folder of files.
[[nodiscard]] bool format_is_folder(MotionFormat format);
/// Names of the files that such a folder may hold.
[[nodiscard]] std::vector<std::string> folder_file_names(MotionFormat format);
/// Whether files in this format have the rate of trackers, TrackingOptions::rate, and not the
/// motion's own.
[[nodiscard]] bool format_has_own_rate(MotionFormat format);
/// Distinguishes files of one motion in several formats: `.csv`, `.soma.csv`, `.mjlab.npz`, ...
[[nodiscard]] std::string_view format_long_ending(MotionFormat format);

/// The dialect of a robot CSV. The defaults are the bytes of Unitree's published G1 data, which
/// BeyondMimic, mjlab, unitree_rl_lab and PBHC read.
struct RobotCsvOptions {
  int precision = 6;     ///< Digits after the decimal point, clamped to 0 to 17.
  char delimiter = ',';  ///< `,`, blank or tab.
  bool header = false;   ///< A header line with the column names.
  QuaternionOrder quaternion_order = QuaternionOrder::kXyzw;
  bool frame_column = false;  ///< A leading column with frame numbers from 0,
  int frame_step = 1;         ///< in steps of this size.
  bool degrees = false;       ///< Hinges in degrees.
  bool centimetres = false;   ///< Root position and slides in centimetres.
  /// The root's rotation as three angles about the fixed axes x, y, z, in that order (R = Rz Ry
  /// Rx), degrees or radians as the joints, in place of a quaternion.
  bool euler = false;
};

/// The dialect of SOMA and BONES-SEED: comma, header, frame column, centimetres, degrees, Euler.
/// Its readers assume 120 frames per second, so its frame numbers count those: if 120 is a multiple
/// of the rate, they increase by 120 / rate (at 30 fps 0, 4, 8, ...), else by one.
[[nodiscard]] RobotCsvOptions soma_csv_options(const FrameRate& rate, int precision = 6);

/// Whether the frame numbers of soma_csv_options encode this rate.
[[nodiscard]] bool soma_csv_tells(const FrameRate& rate);

/// Writes configurations as lines: root position x y z (metres), root quaternion, then the joints
/// (radians, metres for slides) in the robot's output order; other units and columns according to
/// the options. Fixed notation, LF, no negative zeros, the same bytes in every locale.
///
/// A header names columns `root_x`, `root_qx`, the joint's name; with Euler angles as SOMA does:
/// `Frame`, `root_translateX`, `root_rotateX`, the joint's name and `_dof`.
class RobotCsvFormatter {
 public:
  explicit RobotCsvFormatter(const Robot& robot, const RobotCsvOptions& options = {});

  /// The header line, or empty.
  [[nodiscard]] const std::string& header() const { return header_; }

  /// @param qpos   configuration in the layout of RobotClip.
  /// @param frame  frame number, for the frame column.
  void append_line(std::span<const double> qpos, std::string& text, int frame = 0) const;

 private:
  struct Column {
    int address;  // into a configuration
    double factor;
  };
  void append_value(double value, std::string& text) const;

  RobotCsvOptions options_;
  std::vector<Column> position_, rotation_, joints_;  // in the order in which they are written
  std::string header_;
};

/// The whole file for a clip.
[[nodiscard]] std::string format_robot_csv(const RobotClip& clip,
                                           const RobotCsvOptions& options = {});

/// The clip as a reader of its CSV sees it: every number as printed, joints without a column as in
/// the zero configuration, quaternions of unit length and sign-continuous.
/// Errors (kRun): a quaternion that rounds to zero with so few digits.
[[nodiscard]] Result<RobotClip> printed_clip(const RobotClip& clip, int precision = 6);

/// The ends of feet that contacts are of, in their order.
inline constexpr std::array<std::string_view, 4> kContactNames = {"left_heel", "left_toe",
                                                                  "right_heel", "right_toe"};

/// When the ends of a robot's feet are planted: where its human's stand.
struct FootContacts {
  std::vector<std::uint8_t> planted;  ///< By frame, one for each of kContactNames; 1: planted.

  [[nodiscard]] int frame_count() const {
    return static_cast<int>(planted.size() / kContactNames.size());
  }
  /// Whether heel or toe of a foot is. @param foot  0 left, 1 right
  [[nodiscard]] bool foot_planted(int frame, int foot) const {
    const std::size_t heel =
        kContactNames.size() * static_cast<std::size_t>(frame) + 2 * static_cast<std::size_t>(foot);
    return planted[heel] != 0 || planted[heel + 1] != 0;
  }
};

/// Contacts at another rate: each sample has what the frame nearest to its time has.
/// @param frames  of the result.
[[nodiscard]] FootContacts resample_contacts(const FootContacts& contacts, const FrameRate& from,
                                             const FrameRate& to, int frames);

/// As CSV: a header, then frame number, time in seconds and 0 or 1 for each of kContactNames.
[[nodiscard]] std::string format_contacts_csv(const FootContacts& contacts, const FrameRate& rate);

/// Joints and bodies in the arrays of a tracking file, and their order.
///
/// Bodies are the root and those moved by an output joint; bodies fixed to another, or held by the
/// robot's variant, count as part of it (so does Isaac Lab's importer, and mjlab's models have no
/// such bodies). kNpzBeyondMimic and kCsvSonic: Isaac Lab's order, breadth first: by depth in the
/// tree of those bodies, then in MuJoCo's order. Others: MuJoCo's order, depth first.
struct TrackingLayout {
  std::vector<int> joints;  ///< Indices into Robot::joints().
  std::vector<int> bodies;  ///< Indices into Robot::bodies().
  int fixed = 0;  ///< How many of them, the last ones, are fixed to another one: kNpzHolosoma.
};

/// @param format  with bodies: of an NPZ, kProtoMotions or kCsvSonic
[[nodiscard]] TrackingLayout tracking_layout(const Robot& robot, MotionFormat format);

struct TrackingOptions {
  FrameRate rate{50, 1};
  std::optional<BodyPoint> velocity_of;  ///< Empty: as in the format's trainer.
  bool until_last = false;               ///< A sample at the last frame as well, where one falls.
};

/// The arrays that motion trackers train from, row by row; world frame, Z up, SI, wxyz.
struct TrackingMotion {
  MotionFormat format = MotionFormat::kNpzMjlab;
  FrameRate rate;
  std::size_t frames = 0;
  std::vector<std::string> joint_names, body_names;
  std::vector<double> joint_pos, joint_vel;        ///< frames x joints
  std::vector<double> body_pos, body_quat;         ///< frames x bodies x 3, x 4
  std::vector<double> body_lin_vel, body_ang_vel;  ///< frames x bodies x 3
  std::optional<FootContacts> contacts;            ///< At the samples; empty: not known.
};

/// Computes from kinematics alone what BeyondMimic's and mjlab's csv_to_npz get by replaying a CSV
/// in a simulator.
///
/// Samples are at 0, 1/rate, ... strictly before the last frame; between frames positions and
/// joints are linear, rotations slerp. Velocities are central differences of the samples, one-sided
/// at the ends for positions and joints; the root's angular velocity is log(q[i+1] q[i-1]^-1) /
/// (2 dt) in the world, its first and last value repeated. The bodies' velocities follow from those
/// of root and joints.
///
/// Errors (kInput): fewer than three samples, as angular velocities need three.
[[nodiscard]] Result<TrackingMotion> make_tracking_motion(const RobotClip& clip,
                                                          MotionFormat format,
                                                          const TrackingOptions& options = {});

/// As an NPZ file: `fps` (1,) int64, `joint_pos`, `joint_vel`, `body_pos_w`, `body_quat_w`,
/// `body_lin_vel_w`, `body_ang_vel_w` float32; also, ignored by trainers, `flavour`, the names of
/// joints and bodies and, where they are known, `contacts` (frames, 4) bool and `contact_names`.
///
/// kNpzHolosoma: `joint_pos` begins with the root's position and quaternion wxyz, `joint_vel` with
/// its linear and angular velocity in the world.
/// Errors (kRun): 4 GiB or more; a rate that is not whole.
[[nodiscard]] Result<std::string> format_tracking_npz(const TrackingMotion& motion);

/// Of joints without a colour of their own, 0xRRGGBB.
inline constexpr int kPlainColour = 0x8A8A8A;

/// A human's motion as a picture shows it: any clip, and how it lies in a world of metres, Z up.
struct HumanInWorld {
  const Clip* clip = nullptr;  ///< Must outlive this.
  double metres_per_unit = 0.01;
  Pose world_from_clip;      ///< After the lengths were scaled.
  std::vector<int> colours;  ///< By joint, of the bone that ends there, 0xRRGGBB; may be short.
};

struct WriteMotionOptions {
  RobotCsvOptions csv;       ///< Of kCsv; kCsvSoma uses only its precision.
  TrackingOptions tracking;  ///< Of the NPZ formats.
  std::string name;  ///< Of the motion: the key in a kPklPbhc file, the animation's name in a kGlb
                     ///< file; empty: `motion`.
  std::optional<HumanInWorld> human = std::nullopt;  ///< What it came from, shown in a kGlb file.
  /// At the clip's frames, for the formats that have room for them; empty: not known.
  std::optional<FootContacts> contacts = std::nullopt;
};

/// A file of a motion.
struct FormattedFile {
  std::string name;  ///< In its folder; empty: the motion is this one file.
  std::string bytes;
};

/// The bytes of a file that holds the motion.
///
/// kPklGmr: a dictionary of `fps`, `root_pos` (F, 3), `root_rot` (F, 4) xyzw and `dof_pos` (F, n),
/// float64, and `local_body_pos` (F, B, 3) float32: all bodies below the world with the root at the
/// origin and unrotated, named by `link_body_list`.
///
/// kPklPbhc: {name: {`root_trans_offset` (F, 3), `pose_aa` (F, 1 + n + 3, 3): rotation vectors of
/// the root and, about their axes, of the joints, then three zero rows, `dof` (F, n), `root_rot`
/// (F, 4) xyzw, `fps`}}, float32, and where contacts are known `contact_mask` (F, 2), left and
/// right. If the profile has a variant made for PBHC (its name ends in `pbhc`) and the robot is
/// complete, the variant's joints are used.
///
/// kPklMotionLib: the same with all joints of the robot, and `pose_aa` (F, 1 + n, 3).
///
/// kPklMimicKit: `loop_mode` 0, `fps`, `frames`: rows of root position, rotation vector, joints.
///
/// kProtoMotions: a file of PyTorch with a dictionary: `state_conversion`, `fps`, `dof_pos`,
/// `dof_vel`, `rigid_body_pos`, `rigid_body_rot` xyzw, `rigid_body_vel`, `rigid_body_ang_vel`,
/// `rigid_body_contacts`.
///
/// kGlb: glTF 2.0, a node for each body with its shapes as meshes, a rotation (shortest-path
/// quaternions) for each frame and body that a hinge moves, a translation for the root and for
/// bodies that a slide moves, LINEAR; turned so that Y is up. A human stands beside it as a skin. For
/// programs that show motions; nothing reads it back.
///
/// Errors: make_tracking_motion's and format_tracking_npz's; (kRun) a GLB of 4 GiB or more; (kUsage)
/// a format that is a folder.
[[nodiscard]] Result<std::string> format_robot_motion(const RobotClip& clip, MotionFormat format,
                                                      const WriteMotionOptions& options = {});

/// The same for all formats. kCsvSonic: the files of SONIC's folder.
[[nodiscard]] Result<std::vector<FormattedFile>> format_motion_files(
    const RobotClip& clip, MotionFormat format, const WriteMotionOptions& options = {});

/// A human's motion alone as a GLB, see kGlb.
[[nodiscard]] Result<std::string> format_human_glb(const HumanInWorld& human,
                                                   const std::string& name = {});

/// The clip for another variant of its robot: joints go by their names, those held by that variant
/// stay at their held positions.
[[nodiscard]] RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot);

/// The robot of PBHC's files: see kPklPbhc.
[[nodiscard]] Result<std::shared_ptr<const Robot>> pbhc_robot(
    const std::shared_ptr<const Robot>& robot);

/// Joints that move but are held by a variant of the robot: how many, by how much at most, which;
/// empty: none.
[[nodiscard]] std::optional<std::string> lost_joints(const RobotClip& clip, const Robot& variant);

/// What a format cannot store of a motion, one line each: PBHC's files have fewer joints, SOMA's
/// support only 120 frames per second and its divisors.
[[nodiscard]] std::vector<std::string> format_losses(const RobotClip& motion, MotionFormat format);

/// What a motion file does not give, or gives wrongly. Empty: detected, or the format's default.
struct ReadMotionOptions {
  std::optional<MotionFormat> format;         ///< Overrides detection by content.
  std::optional<FrameRate> rate;              ///< Of the file; overrides the file's own.
  std::optional<FrameRate> default_rate;      ///< Of files that give none; empty: 30, SOMA 120.
  std::optional<QuaternionOrder> quaternion;  ///< Of the root, if there is no header.
  /// Hinges, and a root's Euler angles, of a CSV or a pickle; false: radians.
  std::optional<bool> degrees;
  std::optional<double> metres_per_unit;  ///< Root position and slides of a CSV or a pickle.
  bool ignore_header = false;             ///< Reads CSV columns by position even with a header.
  std::string variant;                    ///< Of the robot: whose joints the columns are.
  std::string motion;                     ///< One of several in a kPklPbhc file.
  /// Size limit of the file, and of the numbers of an NPZ's array.
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
};

/// A motion file as it was read.
struct RobotMotion {
  RobotClip clip;
  MotionFormat format = MotionFormat::kCsv;
  bool rate_known = false;               ///< The file has a rate, or one was given.
  std::vector<std::string> notes;        ///< What was detected or guessed, human-readable; one line
                                         ///< each.
  std::vector<std::string> warnings;     ///< Anything odd, human-readable; one line each.
  std::size_t bytes = 0;                 ///< Of the file.
  std::optional<FootContacts> contacts;  ///< Of the clip's frames; empty: the file has none.
};

/// Reads a robot motion in any format of docs/formats.md; the format is detected by content.
///
/// * CSV: columns by the header's names (ignoring letter case, quotes, a path before them and units
///   after them), which must all be understood and name all joints of the robot or of one of its
///   variants; without a header by position: 7 of the root and the joints of the robot or of one of
///   its variants, plus a leading column if it counts up. Frame numbers are ignored, times in s,
///   ms, us or ns give the rate; SOMA's frame numbers count at 120 per second, so steps of 4
///   mean 30. Without a unit, values are in radians and metres, as in our own files.
///   Joints beyond the robot's widest range by more than half a radian (those without a range: four
///   turns), and a root higher than five times what the robot's limbs reach, are refused then;
///   joints beyond their own ranges in most frames, and a root that is never near the ground or too
///   fast, are warned of. SOMA's and BONES-SEED's files are known by their header.
/// * The order of the root's quaternion: the reading in which the robot stands upright, else the
///   one whose lowest sole point slips less. If both fit equally (a robot standing still, facing
///   along x) xyzw, the usual order; a body lying still is refused.
/// * GMR's pickle, PBHC's and ASAP's (also joblib's, compressed or not); read_pickle says what is
///   refused.
/// * Tracking NPZ: the order of joints and bodies is detected by forward kinematics. They are in
///   radians and metres; unit options are refused.
///
/// Joints without a column stay at the zero configuration, joints held by the robot's variant at
/// their held position. Quaternions are normalised and made sign-continuous.
///
/// @param bytes  the whole file.
/// @param file   for messages.
/// @return kInput errors: malformed files; ambiguities, with the option that resolves them.
[[nodiscard]] Result<RobotMotion> parse_robot_motion(std::string_view bytes,
                                                     const std::shared_ptr<const Robot>& robot,
                                                     const std::string& file,
                                                     const ReadMotionOptions& options = {});

/// parse_robot_motion on a file; `-` reads standard input.
[[nodiscard]] Result<RobotMotion> load_robot_motion(const std::string& path,
                                                    const std::shared_ptr<const Robot>& robot,
                                                    const ReadMotionOptions& options = {});

}  // namespace retarget
