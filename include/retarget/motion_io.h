#pragma once

#include <cstddef>
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

namespace RETARGET_API retarget {

/// As on the command line: `csv`, `csv-soma`, `npz-mjlab`, ...
[[nodiscard]] std::string_view format_name(MotionFormat format);
[[nodiscard]] std::vector<std::string> format_names();
/// Errors (kUsage): an unknown name suggests the nearest one and lists all.
[[nodiscard]] Result<MotionFormat> format_from_name(std::string_view name);

/// `.csv`, `.npz` or `.pkl`.
[[nodiscard]] std::string_view format_ending(MotionFormat format);
/// What tells files of one motion in several formats apart: `.csv`, `.soma.csv`, `.mjlab.npz`, ...
[[nodiscard]] std::string_view format_long_ending(MotionFormat format);

/// The dialect of a robot CSV. The defaults are the bytes of Unitree's published G1 data, which
/// BeyondMimic, mjlab, unitree_rl_lab and PBHC read.
struct RobotCsvOptions {
  int precision = 6;     ///< Digits after the decimal point, 0 to 17; others as the nearer of them.
  char delimiter = ',';  ///< `,`, blank or tab.
  bool header = false;   ///< A first line that names the columns.
  QuaternionOrder quaternion_order = QuaternionOrder::kXyzw;
  bool frame_column = false;  ///< A first column that counts frames from 0,
  int frame_step = 1;         ///< by so many.
  bool degrees = false;       ///< Hinges in degrees.
  bool centimetres = false;   ///< Root position and slides in centimetres.
  /// The root's rotation as three angles about the fixed axes x, y, z, in that order (R = Rz Ry
  /// Rx), degrees or radians as the joints, in place of a quaternion.
  bool euler = false;
};

/// The dialect of SOMA and BONES-SEED: comma, header, frame column, centimetres, degrees, Euler.
/// Its readers take 120 frames a second, and so its frame numbers count: where 120 is a multiple of
/// the rate they go up by as many (at 30 fps 0, 4, 8, ...), else by one.
[[nodiscard]] RobotCsvOptions soma_csv_options(const FrameRate& rate, int precision = 6);

/// Whether the frame numbers of soma_csv_options tell this rate.
[[nodiscard]] bool soma_csv_tells(const FrameRate& rate);

/// Writes configurations as lines: root position x y z (metres), root quaternion, then the joints
/// (radians, metres for slides) in the robot's output order; other units and columns as the
/// options say. Fixed notation, LF, no negative zeros, the same bytes in every locale.
///
/// A header names columns `root_x`, `root_qx`, the joint's name; with Euler angles as SOMA does:
/// `Frame`, `root_translateX`, `root_rotateX`, the joint's name and `_dof`.
class RobotCsvFormatter {
 public:
  explicit RobotCsvFormatter(const Robot& robot, const RobotCsvOptions& options = {});

  /// What stands before the first line: the header, or nothing.
  [[nodiscard]] const std::string& header() const { return header_; }

  /// @param qpos   configuration in the layout of RobotClip.
  /// @param frame  its number, for the frame column.
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

/// The clip as a reader of its CSV has it: every number as it is printed, joints that are no columns
/// as in the zero configuration, quaternions of unit length and sign-continuous.
/// Errors (kRun): a quaternion of which so few digits leave nothing.
[[nodiscard]] Result<RobotClip> printed_clip(const RobotClip& clip, int precision = 6);

/// Which joints and bodies the arrays of a tracking file have, and in which order.
///
/// Bodies are the root and those that an output joint moves; what is fixed to a body, or held by
/// the robot's variant, counts as a part of it (so does Isaac Lab's importer, and mjlab's models
/// have no such bodies). kNpzMjlab: MuJoCo's order, depth first. kNpzBeyondMimic: Isaac Lab's,
/// breadth first: by depth in the tree of those bodies, among equals in MuJoCo's order.
struct TrackingLayout {
  std::vector<int> joints;  ///< Indices into Robot::joints().
  std::vector<int> bodies;  ///< Indices into Robot::bodies().
};

/// @param format  kNpzMjlab or kNpzBeyondMimic
[[nodiscard]] TrackingLayout tracking_layout(const Robot& robot, MotionFormat format);

struct TrackingOptions {
  FrameRate rate{50, 1};
  std::optional<BodyPoint> velocity_of;  ///< Nothing: as the format's trainer has it.
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
};

/// What BeyondMimic's and mjlab's csv_to_npz make by replaying a CSV in a simulator, computed by
/// kinematics alone.
///
/// Samples are at 0, 1/rate, ... strictly before the last frame; between frames positions and
/// joints are linear, rotations slerp. Velocities are central differences of the samples, one-sided
/// at the ends for positions and joints; the root's angular velocity is log(q[i+1] q[i-1]^-1) /
/// (2 dt) in the world, its first and last value repeated. The bodies' velocities follow from those
/// of root and joints.
///
/// Errors (kInput): fewer than three samples, for which no angular velocity can be told.
[[nodiscard]] Result<TrackingMotion> make_tracking_motion(const RobotClip& clip,
                                                          MotionFormat format,
                                                          const TrackingOptions& options = {});

/// As an NPZ file: `fps` (1,) int64, `joint_pos`, `joint_vel`, `body_pos_w`, `body_quat_w`,
/// `body_lin_vel_w`, `body_ang_vel_w` float32; beside them, which trainers pass over, `flavour`
/// and the names of joints and bodies. Errors (kRun): 4 GiB or more; a rate that is not whole.
[[nodiscard]] Result<std::string> format_tracking_npz(const TrackingMotion& motion);

struct WriteMotionOptions {
  RobotCsvOptions csv;       ///< Of kCsv; kCsvSoma takes its precision alone.
  TrackingOptions tracking;  ///< Of the NPZ formats.
  std::string name;          ///< Of the motion: the key in a kPklPbhc file; empty: `motion`.
};

/// The bytes of a file that holds the motion.
///
/// kPklGmr: a dictionary of `fps`, `root_pos` (F, 3), `root_rot` (F, 4) xyzw and `dof_pos` (F, n),
/// float64, and, as robot frames of bodies, `local_body_pos` (F, B, 3) float32: all bodies below
/// the world with the root at the origin, unturned, named by `link_body_list`.
///
/// kPklPbhc: {name: {`root_trans_offset` (F, 3), `pose_aa` (F, 1 + n + 3, 3): rotation vectors of
/// the root and, about their axes, of the joints, then three rows of zeros, `dof` (F, n),
/// `root_rot` (F, 4) xyzw, `fps`}}, float32. Where the profile has a variant made for PBHC (its
/// name ends in `pbhc`) and the robot is whole, its joints are taken.
///
/// Errors: make_tracking_motion's and format_tracking_npz's.
[[nodiscard]] Result<std::string> format_robot_motion(const RobotClip& clip, MotionFormat format,
                                                      const WriteMotionOptions& options = {});

/// The clip for another variant of its robot: joints that this one holds are where it holds them.
[[nodiscard]] RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot);

/// The robot that PBHC's files are of: see kPklPbhc.
[[nodiscard]] Result<std::shared_ptr<const Robot>> pbhc_robot(
    const std::shared_ptr<const Robot>& robot);

/// Joints of a motion that move and that a variant of its robot holds: how many, by how much at most,
/// which; nothing: none.
[[nodiscard]] std::optional<std::string> lost_joints(const RobotClip& clip, const Robot& variant);

/// What a format cannot hold of a motion, a line each: PBHC's files have fewer joints, SOMA's no rate
/// but 120 frames a second and what divides it.
[[nodiscard]] std::vector<std::string> format_losses(const RobotClip& motion, MotionFormat format);

/// What a motion file does not say, or says wrongly. Nothing: found, or as the format has it.
struct ReadMotionOptions {
  std::optional<MotionFormat> format;         ///< In place of what the content says.
  std::optional<FrameRate> rate;              ///< Of the file, whatever it says itself.
  std::optional<FrameRate> default_rate;      ///< Of files that say none; nothing: 30, SOMA's 120.
  std::optional<QuaternionOrder> quaternion;  ///< Of the root, where no header tells.
  /// Hinges, and a root's Euler angles, of a CSV or a pickle; false: radians.
  std::optional<bool> degrees;
  std::optional<double> metres_per_unit;  ///< Root position and slides of a CSV or a pickle.
  bool ignore_header = false;             ///< Columns of a CSV by their number, whatever it has.
  std::string variant;                    ///< Of the robot: whose joints the columns are.
  std::string motion;                     ///< One of several in a kPklPbhc file.
  /// Of the file, and of the numbers of an NPZ's array: more are refused.
  std::size_t most_bytes = std::numeric_limits<std::size_t>::max();
};

/// A motion file as it was read.
struct RobotMotion {
  RobotClip clip;
  MotionFormat format = MotionFormat::kCsv;
  bool rate_known = false;            ///< The file has a rate, or one was given.
  std::vector<std::string> notes;     ///< What was found or guessed, for people; one line each.
  std::vector<std::string> warnings;  ///< What is odd, for people; one line each.
  std::size_t bytes = 0;              ///< Of the file.
};

/// Reads a robot's motion from any file that docs/formats.md names; the kind is found by content.
///
/// * CSV: columns by the header's names (letter case, quotes, a path before them and units behind
///   them aside), which must all be understood and name all joints of the robot or of one of its
///   variants; without a header by their number: 7 of the root and the joints of the robot or of one
///   of its variants, one more in front when it counts up. Frame numbers are passed over, times in
///   s, ms, us or ns give the rate; SOMA's frame numbers count frames of 120 a second, so that every
///   fourth of them means 30. What names no unit is in radians and metres, as our own files are.
///   Joints beyond the robot's widest range by more than half a radian, and a root higher than five
///   times what the robot's limbs reach, are refused then; joints beyond their own ranges in most
///   frames, and a root that is never near the ground or too fast, are warned of. SOMA's and
///   BONES-SEED's files are known by their header.
/// * The order of the root's quaternion: of both readings the one that stands upright, else the one
///   whose lowest sole point slips less. Where both are alike (a robot that stands still, facing
///   along x) xyzw, the usual order; a body that lies still is refused.
/// * GMR's pickle, PBHC's and ASAP's (also joblib's, compressed or not); read_pickle says what is
///   refused.
/// * Tracking NPZ: which order joints and bodies are in is found by forward kinematics. They are in
///   radians and metres; options that say units are refused.
///
/// Joints that are no columns stand as in the zero configuration, joints that the robot's variant
/// holds where it holds them. Quaternions are normalised and made sign-continuous.
///
/// @param bytes  the whole file.
/// @param file   for messages.
/// @return kInput errors: malformed files; what cannot be told, with the option that tells it.
[[nodiscard]] Result<RobotMotion> parse_robot_motion(std::string_view bytes,
                                                     const std::shared_ptr<const Robot>& robot,
                                                     const std::string& file,
                                                     const ReadMotionOptions& options = {});

/// parse_robot_motion of a file; `-` reads standard input.
[[nodiscard]] Result<RobotMotion> load_robot_motion(const std::string& path,
                                                    const std::shared_ptr<const Robot>& robot,
                                                    const ReadMotionOptions& options = {});

}  // namespace retarget
