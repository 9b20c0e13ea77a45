#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "smpl/joint_motion.h"
#include "smpl/smpl_body.h"

namespace retarget {

struct SmplReadOptions {
  /// Frames per second in place of the file's, which may then be missing or wrong.
  std::optional<double> source_fps;

  /// Bytes that the clip may take in memory; a file whose clip would take more is an error.
  std::size_t max_clip_bytes = std::numeric_limits<std::size_t>::max();

  /// Height of the generic body in metres, in place of what the betas suggest. Not for a model,
  /// which has its own.
  std::optional<double> height;

  /// The user's body model; nullptr: the generic body. Must live during the call.
  const SmplBody* body = nullptr;

  /// The skeleton has fingers as well, where the file has some that move.
  bool fingers = false;

  std::string take;  ///< Which of several motions, by name or number from 1; empty: the only one.
  std::vector<std::string> joint_names;  ///< Of places of joints; empty: as the file tells.
};

/// A motion of an SMPL body.
struct SmplMotion {
  /// Metres; Z up, as AMASS stores them, and GVHMR's and PHUMA's motions are turned to. Joints are kSmplJointNames in the skeleton of
  /// smpl_skeleton: with all rotations identity it stands in a T-pose along its own y axis and
  /// faces its z; the pelvis's rotation turns that to Z up. The pelvis's translation is its world
  /// position.
  Clip clip;

  SmplFamily family = SmplFamily::kUnknown;
  std::string gender;            ///< `neutral`, `female`, `male`, or empty where not known.
  std::vector<double> betas;     ///< As in the file; empty where there are none.
  bool approximate_body = true;  ///< Bones are of the generic body, not of a model or the file.
  double height = 0.0;           ///< Of the body, metres.
  std::vector<Warning> warnings;
};

/// Reads an AMASS-like motion: an NPZ file with `trans` (F, 3), and either `root_orient` (F, 3)
/// with `pose_body` (F, 63) or `poses` (F, W), W being 66, 72 (SMPL), 156 (SMPL+H) or 165
/// (SMPL-X); rotation vectors in radians, (F, W / 3, 3) serving as well. The pelvis is in columns
/// 0 to 2, the body in 3 to 65; hands are the last 90 columns of the widest two, or `pose_hand` (F, 90), or
/// `left_hand_pose` and `right_hand_pose` (F, 45); the face is dropped.
///
/// The frame rate is `mocap_framerate`, `mocap_frame_rate` or `fps`, a scalar or an array of one.
/// `betas` and `gender` (any text array) may be missing, with a warning.
///
/// The same arrays are read from files of PyTorch and from pickles, under the other names that they
/// have there, and from the single arrays of Motion-X and PHUMA; see open_motion_file.
///
/// Bones come from options.body, else from the file (`rest_offsets`, or places of joints), which come
/// first where there are no betas; else from the generic body with a height of
/// 1.66 m + 0.1 m * betas[0]. `trans` that is plainly in centimetres or millimetres is taken so, with
/// a warning. The world position of the pelvis is trans plus its place in the
/// rest body. Betas of the other family do not fit a model: it then keeps its mean shape, with a
/// warning.
///
/// Errors (kInput; kUsage for options that are no rate or height) name the array and, where values
/// are bad, the frame: numbers that are not finite, lengths that differ, no frame rate, Python
/// objects.
/// @param bytes      the whole file.
/// @param file_name  as the user named it, for messages.
[[nodiscard]] Result<SmplMotion> read_smpl(std::string_view bytes, const std::string& file_name,
                                           const SmplReadOptions& options = {});

/// What a file of arrays holds: a motion of SMPL, or places of joints.
using ArrayMotion = std::variant<SmplMotion, JointMotion>;

/// Reads either by the file's content: read_smpl, read_joint_motion.
[[nodiscard]] Result<ArrayMotion> read_array_motion(std::string_view bytes,
                                                    const std::string& file_name,
                                                    const SmplReadOptions& options = {});

}  // namespace retarget
