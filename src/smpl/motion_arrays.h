#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/npz.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "smpl/smpl_body.h"

namespace retarget {

/// What an SMPL motion file says, under whichever names, checked and brought to one form.
struct MotionArrays {
  int frame_count = 0;
  /// Rotation vectors in rad, frame-major, kSmplJointCount in a frame by kSmplJointNames.
  std::vector<Eigen::Vector3d> rotations;
  std::vector<Eigen::Vector3d> translations;  ///< `trans`, one per frame, metres.
  FrameRate rate;
  std::vector<double> betas;  ///< Empty: none.
  std::string gender;         ///< Empty: not known.
  SmplFamily family = SmplFamily::kUnknown;
  std::vector<Warning> warnings;
};

/// @param source_fps  in place of the file's frame rate; positive and finite.
[[nodiscard]] Result<MotionArrays> read_motion_arrays(const NpzFile& file,
                                                      std::optional<double> source_fps);

}  // namespace retarget
