#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/smpl/joint_motion.h"
#include "formats/smpl/smpl_body.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// A motion of an SMPL body.
struct SmplMotion {
  /// Metres, Z up: as AMASS stores motions; GVHMR's and PHUMA's are rotated to it. The skeleton is
  /// that of smpl_skeleton with joints kSmplJointNames. With all rotations identity it stands in a
  /// T-pose along its own y axis and faces along z; the pelvis rotation turns it to Z up. The
  /// pelvis translation is its world position.
  Clip clip;

  SmplFamily family = SmplFamily::kUnknown;
  std::string gender;            ///< `neutral`, `female`, `male`, or empty if unknown.
  std::vector<double> betas;     ///< Shape parameters of the file; empty if there are none.
  bool approximate_body = true;  ///< Bone lengths come from the generic body.
  double height = 0.0;           ///< Body height, metres.
  std::vector<Warning> warnings;
  std::optional<Eigen::Vector3d> up = {};  ///< Up axis by definition of the kind of file.
};

/// Content of a file of arrays: an SMPL motion or joint positions.
using ArrayMotion = std::variant<SmplMotion, JointMotion>;

/// Reads a file by its content: joint positions with read_joint_motion, otherwise an AMASS-like
/// motion: an NPZ file with `trans` (F, 3) and either `root_orient` (F, 3) with `pose_body`
/// (F, 63), or `poses` (F, W), where W is 66, 72 (SMPL), 156 (SMPL+H) or 165 (SMPL-X). Rotations
/// are rotation vectors in radians; shape (F, W / 3, 3) is accepted as well. The pelvis is in
/// columns 0 to 2, the body in 3 to 65. Hands are the last 90 columns of the two widest layouts, or
/// `pose_hand` (F, 90), or `left_hand_pose` and `right_hand_pose` (F, 45); if they move, the
/// skeleton has fingers. The face is dropped.
///
/// The frame rate is `mocap_framerate`, `mocap_frame_rate` or `fps`, a scalar or an array with one
/// element. `betas` and `gender` (any text array) may be missing, with a warning.
///
/// The same arrays are also read from PyTorch files and pickles, under the names they have there,
/// and from the single arrays of Motion-X and PHUMA; see open_motion_file.
///
/// Bone lengths come from options.body, otherwise from the file (`rest_offsets`, or joint
/// positions), otherwise from the generic body with a height of 1.66 m + 0.1 m * betas[0]. If there
/// are no betas, the file takes precedence over options.body. A `trans` that is evidently in
/// centimetres or millimetres is converted, with a warning. The world position of the pelvis is
/// trans plus its position in the rest body. If the betas belong to the other model family, the
/// model keeps its mean shape, with a warning.
///
/// Errors (kInput; kUsage for an invalid rate in the options) name the array and, for bad
/// values, the frame: numbers that are not finite, different lengths, no frame rate, Python
/// objects.
/// @param bytes      the whole file.
/// @param file_name  name given by the user, for messages.
[[nodiscard]] Result<ArrayMotion> read_array_motion(std::string_view bytes,
                                                    const std::string& file_name,
                                                    const ArrayReadOptions& options = {});

/// Whether a file has arrays with names of a human motion, or several such motions, or is cut off or
/// damaged, so that its content is unknown. The values of the arrays are not checked.
[[nodiscard]] bool may_hold_array_motion(std::string_view bytes);

}  // namespace retarget
