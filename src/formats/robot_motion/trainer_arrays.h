#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/array_source.h"
#include "formats/robot_motion/raw_motion.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// Names and order of the arrays in files of training frameworks: one row per layout.
struct TrainerLayout {
  MotionFormat format;
  std::string_view joints;              ///< (frames, joints).
  std::string_view position, rotation;  ///< Arrays of the root: (frames, 3), (frames, 4).
  /// They have all bodies, the root first: (frames, bodies, 3), (frames, bodies, 4).
  bool bodies;
  QuaternionOrder order;
  bool order_known;  ///< Otherwise the order is only the usual one.
};

inline constexpr TrainerLayout kGmrLayout = {
    MotionFormat::kPklGmr, "dof_pos", "root_pos", "root_rot", false, QuaternionOrder::kXyzw, false};
inline constexpr TrainerLayout kMotionLibLayout = {
    MotionFormat::kPklPbhc, "dof", "root_trans_offset", "root_rot", false,
    QuaternionOrder::kXyzw, false};
inline constexpr TrainerLayout kProtoLayout = {
    MotionFormat::kProtoMotions, "dof_pos", "rigid_body_pos", "rigid_body_rot", true,
    QuaternionOrder::kXyzw,      true};
inline constexpr TrainerLayout kTrackingLayout = {
    MotionFormat::kNpzMjlab, "joint_pos", "body_pos_w", "body_quat_w", true,
    QuaternionOrder::kWxyz,  true};

struct TrainerArrays {
  RawMotion raw;
  std::size_t bodies = 1;
  std::vector<double> position, rotation;  ///< Arrays of all bodies, if the layout has them.
};

/// Reads joints, root and rate in metres and radians.
[[nodiscard]] Result<TrainerArrays> read_trainer_arrays(const ArraySource& file,
                                                        const TrainerLayout& layout);

/// Sets radians and metres, the units of every trainer's format.
void set_units_of_format(RawMotion& raw);

/// Sets the rate of a motion to the file's `fps`, if it has one.
[[nodiscard]] Result<void> take_rate(const ArraySource& file, RawMotion& raw);

/// Reads an array of numbers with this number of dimensions.
[[nodiscard]] Result<NpyArray> read_numbers(const ArraySource& file, std::string_view name,
                                            std::size_t dimensions);

/// Takes the positions of the bodies that a file names, for check_body_places(). Takes none if the
/// arrays are missing, are not of this kind, or name fewer than three bodies of the robot.
/// @param positions  name of the array (frames, bodies, 3).
/// @param names      name of the list of body names.
void take_named_bodies(const ArraySource& file, const Robot& robot, std::string_view positions,
                       std::string_view names, RawMotion& raw);

/// A body in ProtoMotions' arrays: a body of the tracking layout, or a point fixed to one.
struct ProtoBody {
  std::string name;
  std::string carrier;                              ///< Body that gives the rotation.
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< Position in the carrier's frame, metres.
};

/// The bodies of a robot's motions in ProtoMotions' order. For the G1 these are the bodies of
/// ProtoMotions' own model, which adds a head and hands. For other robots they are the root and all
/// bodies moved by a joint, depth first.
[[nodiscard]] std::vector<ProtoBody> proto_bodies(const Robot& robot);

/// Index of the body that is a foot. @param side  `left` or `right`. Returns nothing if the robot's
/// feet are unknown.
[[nodiscard]] std::optional<std::size_t> proto_foot(const Robot& robot,
                                                    const std::vector<ProtoBody>& bodies,
                                                    std::string_view side);

}  // namespace retarget
