#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The joints shared by SMPL, SMPL+H and SMPL-X, in their order: the body without hands.
inline constexpr std::array<std::string_view, 22> kSmplJointNames = {
    "pelvis",     "left_hip",    "right_hip",    "spine1",     "left_knee",     "right_knee",
    "spine2",     "left_ankle",  "right_ankle",  "spine3",     "left_foot",     "right_foot",
    "neck",       "left_collar", "right_collar", "head",       "left_shoulder", "right_shoulder",
    "left_elbow", "right_elbow", "left_wrist",   "right_wrist"};

inline constexpr int kSmplJointCount = static_cast<int>(kSmplJointNames.size());

/// Parent of each joint, by index into kSmplJointNames; -1 for the pelvis.
inline constexpr std::array<int, kSmplJointCount> kSmplParents = {
    -1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19};

/// Number of hand joints, which follow the body's joints in SMPL+H and SMPL-X (in SMPL-X after jaw
/// and eyes): left index, middle, little and ring finger and thumb with three joints each, then the
/// right hand.
inline constexpr int kSmplHandJointCount = 30;

/// End points of the body beyond its last joints.
enum SmplTip : std::uint8_t { kHeadTop, kLeftToes, kRightToes, kLeftFingers, kRightFingers };
inline constexpr int kSmplTipCount = 5;

/// Joint at which each tip is attached, by SmplTip: head, left and right foot, left and right
/// wrist.
inline constexpr std::array<int, kSmplTipCount> kSmplTipJoints = {15, 10, 11, 20, 21};

/// A body in the zero pose (all rotations zero): a T-pose, palms down.
///
/// Metres, in the models' axes: x to the body's left, y up, z forward. The origin is the model's
/// origin, which `trans` of a motion translates.
struct SmplRestBody {
  std::array<Eigen::Vector3d, kSmplJointCount> joints;  ///< Positions in the order of
                                                        ///< kSmplJointNames.
  std::array<Eigen::Vector3d, kSmplTipCount> tips;      ///< Positions, indexed by SmplTip.
  double height = 0.0;  ///< Height from the soles to the top of the head.
  /// Positions of the hand joints (kSmplHandJointCount). If empty, a skeleton with fingers uses
  /// average ones.
  std::vector<Eigen::Vector3d> hands = {};
};

/// A body of average adult proportions, for motions without a model. Joints are at fixed fractions
/// of the height, from published anthropometry (docs/smpl.md has the table and its sources); no
/// data comes from a body model. The origin is the pelvis.
/// @param height  metres, greater than 0.
[[nodiscard]] SmplRestBody generic_smpl_rest_body(double height);

/// Body height in metres implied by betas when nothing else is known: 1.66 m + 0.1 m * betas[0],
/// the rule of thumb of other retargeters. The result is not checked and may be implausible.
[[nodiscard]] double smpl_height_of_betas(std::span<const double> betas);

/// Whether a height in metres is plausible for a human.
[[nodiscard]] bool is_human_height(double height);

/// A body from the joint offsets to their parents in the zero pose, which some motion files
/// contain. The pelvis offset is ignored; the origin is the pelvis. Tips and height come from the
/// generic body that has the same height of the head above the ankles.
/// @param offsets  offsets in the order of kSmplJointNames, metres, in the models' axes.
/// @return nothing if the offsets are not those of a T-pose body in metres.
[[nodiscard]] std::optional<SmplRestBody> smpl_rest_body_of_offsets(
    std::span<const Eigen::Vector3d> offsets);

/// The skeleton of a body: joints by name, depth first, with tips as end sites. With all rotations
/// identity it stands in the T-pose. The pelvis has position channels; its offset is its position
/// in the body's axes.
/// @param fingers  include the hand joints.
[[nodiscard]] std::shared_ptr<const Skeleton> smpl_skeleton(const SmplRestBody& body,
                                                            bool fingers = false);

/// Maps joints of smpl_skeleton to indices into kSmplJointNames; larger indices are hand joints.
[[nodiscard]] std::vector<int> smpl_skeleton_order(bool fingers = false);

/// Computes the joint rotations of smpl_skeleton in one frame.
/// @param order           result of smpl_skeleton_order.
/// @param rotations       rotation vectors in rad, in the order of kSmplJointNames.
/// @param hand_rotations  rotation vectors of the hand joints, if `order` includes them.
/// @param y_is_up         the world has Y up; the pose is rotated to Z up.
/// @param joints          output: parent_from_joint of each joint.
/// @param pelvis          world position of the pelvis, rotated in place.
void pose_smpl_skeleton(std::span<const int> order, std::span<const Eigen::Vector3d> rotations,
                        std::span<const Eigen::Vector3d> hand_rotations, bool y_is_up,
                        std::span<Eigen::Quaterniond> joints, Eigen::Vector3d& pelvis);

}  // namespace retarget
