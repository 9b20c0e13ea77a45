#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Local rotations of a joint by frame; neighbours have a dot product >= 0.
[[nodiscard]] std::vector<Eigen::Quaterniond> rotation_track(const Clip& clip, FrameRange part,
                                                             int joint);

/// Noise of the joints of a clip.
struct JointJitter {
  std::vector<int> joints;    ///< The joints to smooth if they may have noise; empty: no jitter.
  std::vector<double> steps;  ///< Changes of the errors of the jittery joints, rad per frame.
  bool white = false;         ///< Whether their errors are independent (has_white_noise).
  std::string of;             ///< Their part: `11 of 20 joints`, `3 joints of the left leg`.
};

/// Measures whether a clip has noise: in half of all moving joints, else in the hips, in two joints
/// of a leg, of an arm, or of the spine. Other single joints do not suffice: feet, toes, wrists and
/// necks of good recordings can be noisy.
[[nodiscard]] JointJitter find_jitter(const Clip& clip, FrameRange part,
                                      const Calibration& calibration);

}  // namespace retarget
