#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/containers/array_source.h"
#include "formats/smpl/smpl_body.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// The content of an SMPL motion file, validated and converted to one form.
struct MotionArrays {
  int frame_count = 0;
  /// Rotation vectors in rad, frame-major, kSmplJointCount per frame in the order of
  /// kSmplJointNames.
  std::vector<Eigen::Vector3d> rotations;
  /// Rotation vectors of the hand joints, kSmplHandJointCount per frame. Empty if the file has none
  /// or the hands never move.
  std::vector<Eigen::Vector3d> hand_rotations;
  std::vector<Eigen::Vector3d> translations;  ///< `trans`: one per frame, metres.
  FrameRate rate;
  std::vector<double> betas;  ///< Empty if the file has none.
  std::string gender;         ///< Empty if unknown.
  SmplFamily family = SmplFamily::kUnknown;
  std::optional<SmplRestBody> body;  ///< Body of the file itself, with its pelvis at the origin.
  std::vector<Warning> warnings;
};

/// Facts that follow from the kind of motion rather than from its arrays.
struct MotionKind {
  std::optional<double> fps;  ///< Rate for files without one, Hz.
  std::string fps_reason;     ///< Text of the warning that this rate is assumed; empty: no warning.
  std::string gender;         ///< For files without a gender, such as `neutral`; empty if unknown.
  bool has_no_betas = false;  ///< Files of this kind never have betas, so no warning is needed.
  bool y_is_up = false;       ///< The file's world has Y up; the motion is rotated to Z up.
  /// Up axis by definition of the kind, after that rotation. Empty: inferred from the motion.
  std::optional<Eigen::Vector3d> up;
  SmplFamily family = SmplFamily::kUnknown;
  std::optional<SmplRestBody> body;
};

/// Whether the file has motion rotations under a known name.
[[nodiscard]] bool has_motion(const ArraySource& file);

/// Whether rotations and translations use AMASS's names.
[[nodiscard]] bool has_amass_names(const ArraySource& file);

/// Reads and validates the arrays of a motion.
/// @param source_fps  overrides the file's frame rate, Hz; positive and finite.
[[nodiscard]] Result<MotionArrays> read_motion_arrays(const ArraySource& file,
                                                      const MotionKind& kind,
                                                      std::optional<double> source_fps);

}  // namespace retarget
