#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// The joints that SMPL, SMPL+H and SMPL-X have in common, in their order: the body without hands.
inline constexpr std::array<std::string_view, 22> kSmplJointNames = {
    "pelvis",     "left_hip",    "right_hip",    "spine1",     "left_knee",     "right_knee",
    "spine2",     "left_ankle",  "right_ankle",  "spine3",     "left_foot",     "right_foot",
    "neck",       "left_collar", "right_collar", "head",       "left_shoulder", "right_shoulder",
    "left_elbow", "right_elbow", "left_wrist",   "right_wrist"};

inline constexpr int kSmplJointCount = static_cast<int>(kSmplJointNames.size());

/// Parent of each joint, by index into kSmplJointNames; -1 for the pelvis.
inline constexpr std::array<int, kSmplJointCount> kSmplParents = {
    -1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19};

/// Joints of both hands, which SMPL+H and SMPL-X have after the body's (SMPL-X behind jaw and eyes): the left
/// index, middle, little and ring finger and the thumb with three each, then the right ones.
inline constexpr int kSmplHandJointCount = 30;

/// Ends of the body beyond its last joints.
enum SmplTip : std::uint8_t { kHeadTop, kLeftToes, kRightToes, kLeftFingers, kRightFingers };
inline constexpr int kSmplTipCount = 5;

/// The joint that each tip ends, by SmplTip: head, left and right foot, left and right wrist.
inline constexpr std::array<int, kSmplTipCount> kSmplTipJoints = {15, 10, 11, 20, 21};

/// Models whose betas mean the same shapes.
enum class SmplFamily : std::uint8_t {
  kUnknown,
  kSmpl,   ///< SMPL and SMPL+H.
  kSmplx,  ///< SMPL-X, whose betas are others.
};

/// A body in the zero pose (all rotations zero): a T-pose, palms down.
///
/// Metres, in the models' own axes: x to the body's left, y up, z to where it faces. The origin is
/// the model's: what `trans` of a motion moves.
struct SmplRestBody {
  std::array<Eigen::Vector3d, kSmplJointCount> joints;  ///< By kSmplJointNames.
  std::array<Eigen::Vector3d, kSmplTipCount> tips;      ///< By SmplTip.
  double height = 0.0;                                  ///< Soles to the top of the head.
  /// Of the hands (kSmplHandJointCount); empty: a skeleton with fingers takes average ones.
  std::vector<Eigen::Vector3d> hands = {};
};

/// A body of average adult proportions, for motions without a model: joints at fixed fractions of
/// the height, from published anthropometry (docs/smpl.md has the table and its sources); nothing
/// in it comes from a body model. The origin is the pelvis.
/// @param height  in metres, above 0.
[[nodiscard]] SmplRestBody generic_smpl_rest_body(double height);

/// The height that goes with betas where nothing else is known of a body, metres: 1.66 m + 0.1 m * betas[0],
/// the rule of thumb that other retargeters use. Not checked: betas may be no human's.
[[nodiscard]] double smpl_height_of_betas(std::span<const double> betas);

/// Whether a body may be so high, metres.
[[nodiscard]] bool is_human_height(double height);

/// The body whose joints are at these offsets from their parents in the zero pose, as some motions
/// have them; that of the pelvis is not looked at. The origin is the pelvis. Tips and height are
/// those of the generic body with the same head above the same ankles.
/// @param offsets  by kSmplJointNames, metres, in the models' axes.
/// @return nothing where these are no joints of a body in metres that stands in a T-pose.
[[nodiscard]] std::optional<SmplRestBody> smpl_rest_body_of_offsets(
    std::span<const Eigen::Vector3d> offsets);

/// The user's own body model, cut down to what joints need: each point is linear in the betas.
struct SmplBody {
  std::string file;
  SmplFamily family = SmplFamily::kUnknown;
  /// x, y, z of the joints, the tips, the lowest vertex, and of the joints of the hands where the model
  /// has them, in metres, all betas zero.
  Eigen::VectorXd points;
  /// Change of `points` per beta, one column each.
  Eigen::MatrixXd shape_directions;

  [[nodiscard]] int beta_count() const { return static_cast<int>(shape_directions.cols()); }
};

/// Reads a model file of SMPL-X or SMPL+H: an NPZ with v_template (V, 3), shapedirs (V, 3, B),
/// J_regressor (J, V) as a dense array and kintree_table (2, J); other arrays are not looked at.
///
/// Joints are J_regressor * (v_template + shapedirs * betas), which holds on the rest mesh only.
/// Tips are vertices: the ends of the unshaped mesh. Of SMPL-X's shapedirs the first 300 (of old
/// files with fewer than 400: 10) belong to betas, the others to the face.
///
/// Errors (kConfig): no NPZ file (SMPL's pickles among them: nothing is unpickled), arrays that
/// are missing, of objects (a sparse J_regressor), of other shapes or not finite, joints that are
/// not SMPL's, a mesh that is no body in metres.
/// @param bytes      the whole file.
/// @param file_name  as the user named it, for messages.
[[nodiscard]] Result<SmplBody> read_smpl_body(std::string_view bytes, const std::string& file_name);

/// read_smpl_body of a file.
[[nodiscard]] Result<SmplBody> load_smpl_body(const std::string& path);

/// The model's body of these betas. Missing ones count as zero, further ones are left out.
[[nodiscard]] SmplRestBody smpl_rest_body(const SmplBody& body, std::span<const double> betas);

/// The skeleton of a body: the joints by their names, depth first, tips as end sites. With all
/// rotations identity it stands in the T-pose. The pelvis has position channels; its offset is
/// where it lies in the body's axes.
/// @param fingers  with the joints of the hands.
[[nodiscard]] std::shared_ptr<const Skeleton> smpl_skeleton(const SmplRestBody& body,
                                                            bool fingers = false);

/// Joints of smpl_skeleton as indices into kSmplJointNames; those of the hands follow on these.
[[nodiscard]] std::vector<int> smpl_skeleton_order(bool fingers = false);

/// Poses that skeleton in a frame.
/// @param order           smpl_skeleton_order's.
/// @param rotations       vectors in rad by kSmplJointNames.
/// @param hand_rotations  the same of the hands, where the order has them.
/// @param y_is_up         the world has y up; it is turned to z.
/// @param joints          filled: of each joint, parent_from_joint.
/// @param pelvis          its world position, turned along.
void pose_smpl_skeleton(std::span<const int> order, std::span<const Eigen::Vector3d> rotations,
                        std::span<const Eigen::Vector3d> hand_rotations, bool y_is_up,
                        std::span<Eigen::Quaterniond> joints, Eigen::Vector3d& pelvis);

}  // namespace retarget
