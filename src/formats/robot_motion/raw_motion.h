#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/file_endings.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// Range of frame rates that a file may declare, Hz.
inline constexpr double kMinFileRate = 1e-3;
inline constexpr double kMaxFileRate = 1e6;

/// Unit of angles in files, in radians.
inline constexpr double kRadiansPerDegree = 0.01745329251994329577;

/// A point of a robot that may touch the floor, or that a file contains.
struct TouchPoint {
  int body;
  Eigen::Vector3d place;  ///< Position in the body's frame, metres.
};

/// A body in a file's array of body positions.
struct PlacedBody {
  std::size_t column;  ///< Index of the body in the array.
  TouchPoint point;
};

/// Positions of bodies in a file. Forward kinematics confirms the units and orders by them.
struct BodyPlaces {
  std::vector<PlacedBody> bodies;  ///< Bodies of the robot; empty: nothing to compare.
  std::vector<double> positions;   ///< 3 per body of the array, for each frame.
  bool of_root = false;  ///< Whether positions are relative to the root; otherwise in the world.
};

/// A motion as stored in its file. The columns are identified; units and orders may still be
/// unknown.
struct RawMotion {
  MotionFormat format = MotionFormat::kCsv;
  std::optional<FrameRate> rate;  ///< Rate declared in the file.
  std::size_t frames = 0;
  std::vector<double> position;  ///< 3 per frame.
  std::vector<double> rotation;  ///< 4 per frame, in the file's order.
  /// Instead of `rotation`: 3 per frame, angles about the fixed axes x, y, z (R = Rz Ry Rx), in the
  /// unit of the joints.
  std::vector<double> euler;
  std::optional<QuaternionOrder> order;            ///< Set if the file declares it.
  QuaternionOrder usual = QuaternionOrder::kXyzw;  ///< The format's usual order.
  std::vector<double> joints;                      ///< joint_count per frame.
  std::size_t joint_count = 0;
  std::vector<int> joint_indices;  ///< Indices into Robot::joints(); empty: identified by their
                                   ///< count.
  std::optional<bool> degrees;     ///< Set if the file declares the unit.
  std::optional<double> metres_per_unit;  ///< Set if the file declares the unit.
  /// Both units are those of the format, and nothing in the file states them.
  bool units_of_format = false;
  BodyPlaces places;
  std::optional<FootContacts> contacts;      ///< Empty if the file has none.
  std::vector<std::string> notes, warnings;  ///< See RobotMotion.
};

/// Readers of a family of formats, for the table of formats.
[[nodiscard]] Result<RawMotion> read_csv_motion(std::string_view bytes,
                                                const std::shared_ptr<const Robot>& robot,
                                                const std::string& file,
                                                const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_npz_motion(std::string_view bytes,
                                                const std::shared_ptr<const Robot>& robot,
                                                const std::string& file,
                                                const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_pickle_motion(std::string_view bytes,
                                                   const std::shared_ptr<const Robot>& robot,
                                                   const std::string& file,
                                                   const ReadMotionOptions& options);
[[nodiscard]] Result<RawMotion> read_protomotions(std::string_view bytes,
                                                  const std::shared_ptr<const Robot>& robot,
                                                  const std::string& file,
                                                  const ReadMotionOptions& options);
/// Reads the folder `file`; `bytes` are not used.
[[nodiscard]] Result<RawMotion> read_sonic_folder(std::string_view bytes,
                                                  const std::shared_ptr<const Robot>& robot,
                                                  const std::string& file,
                                                  const ReadMotionOptions& options);

/// Converts a motion from the units and orders of its file to the robot's.
[[nodiscard]] Result<RobotMotion> interpret_motion(RawMotion& raw,
                                                   const std::shared_ptr<const Robot>& robot,
                                                   const std::string& file,
                                                   const ReadMotionOptions& options);

/// Maps the joints of a file with `count` joints to the robot's: its output joints, those of the
/// whole robot, or those of one of its variants. Errors (kInput): no such set, or several, have
/// this count.
[[nodiscard]] Result<std::vector<int>> joints_by_count(const Robot& robot, std::size_t count,
                                                       const RawMotion& raw,
                                                       const std::string& file,
                                                       const std::string& variant);

/// The robot's variants with this number of output joints; only `variant` if it is not empty. If
/// several fit a PBHC file, only the variants made for that format remain.
[[nodiscard]] std::vector<std::string> variants_by_count(const Robot& robot, std::size_t count,
                                                         MotionFormat format,
                                                         const std::string& variant);

/// Output joints of a variant; of the whole robot if `name` is empty.
[[nodiscard]] std::vector<int> output_joints_of(const Robot& robot, const std::string& name);

/// Maps joints of a variant, which may have its own model, to the robot's.
[[nodiscard]] std::vector<int> joints_among(const Robot& robot, const Robot& variant,
                                            const std::vector<int>& joints);

/// Evidence for each of the two orders of four quaternion columns.
struct OrderEvidence {
  double upright[2] = {0.0, 0.0};  ///< Mean z component of the root's z axis, by QuaternionOrder.
  double slip[2] = {0.0, 0.0};     ///< Mean slip of the lowest point, metres per frame.
  /// Values of `upright` and `slip` if the file has y up.
  double upright_if_y_up[2] = {0.0, 0.0};
  double slip_if_y_up[2] = {0.0, 0.0};
};

/// The chosen order and the reason; no order if the evidence is inconclusive.
struct OrderGuess {
  std::optional<QuaternionOrder> order;
  bool contradictory =
      false;  ///< The robot stands upright in one order and slips less in the other.
  std::string reason;
};

/// Evaluates the motion with both orders.
/// @param configurations  motion in RobotClip's layout, metres and radians; root rotations are
///   ignored.
[[nodiscard]] OrderEvidence weigh_orders(const RobotClip& configurations, const RawMotion& raw);

/// Chooses the order in which the robot stands along y if its feet then slip much less than along z
/// in either order; otherwise the order in which the robot stands upright; otherwise the one whose
/// feet slip less. If the robot stands upright and hardly moves in both, chooses the usual order.
/// Chooses none if the robot stands upright in the other order, but slips much less in the usual
/// one.
/// (The dot product of consecutive quaternions is the same for both orders, so continuity of the
/// rotation alone proves nothing; continuity of the standing foot is.)
[[nodiscard]] OrderGuess guess_order(const OrderEvidence& evidence, QuaternionOrder usual);

/// Chooses the order in which the root has the rotation of the robot's fixed base in every frame.
/// If both fit, chooses the usual one; if none fits, returns no order.
[[nodiscard]] OrderGuess order_of_fixed_base(const Robot& robot, const RawMotion& raw);

/// The points of the soles, or the body origins if the robot has no soles.
[[nodiscard]] std::vector<TouchPoint> touch_points(const Robot& robot);

/// Determines the units of a motion and sets RawMotion::degrees and metres_per_unit.
///
/// Options take precedence, then declarations in the file. Without either, the units are those of
/// the format, or radians and metres, however unusual the values are: a guess by magnitude would
/// turn a robot on a roof into one that lies on the ground. Contrary evidence gives an error or a
/// warning, but never another unit.
///
/// @param raw  its numbers are finite and its joint_indices are known.
/// Errors (kInput): joint positions beyond the robot's widest range (without a range: beyond four
/// turns), a root beyond its reach (unless bodies in the world frame decide the unit).
[[nodiscard]] Result<void> find_units(const Robot& robot, const std::string& file,
                                      const ReadMotionOptions& options, RawMotion& raw);

/// Checks whether a motion whose file does not state the unit of length can be in metres. It runs
/// last because it needs the quaternion order: a lying robot may be low, a standing one may not.
///
/// @param raw  receives warnings about the unit.
/// Errors (kInput): an upright root almost on the ground with feet far below it, as in a motion
/// that is ten or a hundred times too small.
[[nodiscard]] Result<void> check_assumed_metres(const RobotClip& clip, const std::string& file,
                                                RawMotion& raw);

/// Sets the configuration of a frame, in RobotClip's layout. Returns false if the frame has none.
using FramePose = std::function<bool(std::size_t frame, std::span<double> qpos)>;

/// The largest distance of bodies from their forward kinematics over a sample of frames, metres;
/// infinite if a position is not finite.
/// @param positions  positions in the layout of BodyPlaces, metres.
[[nodiscard]] double largest_body_distance(const Robot& robot, std::span<const PlacedBody> bodies,
                                           std::span<const double> positions, std::size_t frames,
                                           const FramePose& pose);

/// Compares a motion with RawMotion::places.
/// @param clip   the motion, from `raw` with this quaternion order.
/// Errors (kInput): bodies are in other places; the unit or the order that would explain them.
[[nodiscard]] Result<void> check_body_places(const RobotClip& clip, const RawMotion& raw,
                                             QuaternionOrder order, const std::string& file);

}  // namespace retarget
