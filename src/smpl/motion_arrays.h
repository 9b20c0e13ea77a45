#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "smpl/array_source.h"
#include "smpl/smpl_body.h"

namespace retarget {

/// What an SMPL motion file says, under whichever names, checked and brought to one form.
struct MotionArrays {
  int frame_count = 0;
  /// Rotation vectors in rad, frame-major, kSmplJointCount in a frame by kSmplJointNames.
  std::vector<Eigen::Vector3d> rotations;
  /// The same of the hands, kSmplHandJointCount in a frame; empty: the file has none, or none that move.
  std::vector<Eigen::Vector3d> hand_rotations;
  std::vector<Eigen::Vector3d> translations;  ///< `trans`, one per frame, metres.
  FrameRate rate;
  std::vector<double> betas;  ///< Empty: none.
  std::string gender;         ///< Empty: not known.
  SmplFamily family = SmplFamily::kUnknown;
  std::optional<SmplRestBody> body;  ///< The file's own, its pelvis at the origin.
  std::vector<Warning> warnings;
};

/// What is known of a motion by its kind, beside what its arrays say.
struct MotionKind {
  std::optional<double> fps;  ///< Of files that state no rate.
  std::string fps_reason;     ///< Why, for the warning that says so; empty: no warning.
  std::string gender;         ///< Of files that state none, as `neutral`; empty: not known.
  bool has_no_betas = false;  ///< No file of the kind has any, which needs no warning.
  bool y_is_up = false;       ///< The world of such files, else what the movement shows.
  SmplFamily family = SmplFamily::kUnknown;
  std::optional<SmplRestBody> body;
};

/// Whether there are arrays with the rotations of a motion, under any of the names that are read.
[[nodiscard]] bool has_motion(const ArraySource& file);

/// @param source_fps  in place of the file's frame rate; positive and finite.
[[nodiscard]] Result<MotionArrays> read_motion_arrays(const ArraySource& file,
                                                      const MotionKind& kind,
                                                      std::optional<double> source_fps);

}  // namespace retarget
