#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Interpolates over frames in which a joint is lost: its rotation is exactly zero for at most a
/// second, the joint is far from zero before and after and jumps in one frame, while other joints
/// continue to move.
/// @return one sentence per joint: `LeftForeArm was lost in 9 frames`.
std::vector<std::string> bridge_lost_joints(Clip& clip, FrameRange part);

/// Limbs that keep their pose through a clip while the others move: they were not tracked.
struct StillLimbs {
  std::vector<std::string> names;  ///< Names such as `left leg`.
  bool leg = false;                ///< Whether one of them is a leg.
};

/// Finds a leg or an arm whose bones turn by less than 0.2 degrees relative to the bones that they
/// hang on, while the other one and a leg turn by more than 10. A leg that only stands also keeps
/// its pose, so the foot of a still leg must travel over the ground. Looks at the whole clip,
/// because a limb may be held still in an excerpt.
[[nodiscard]] StillLimbs find_still_limbs(const Clip& clip, const Calibration& calibration);

/// Jitter of a track of rotations or positions, measured by changes of velocity between frames. In
/// a movement neighbouring changes are similar; in noise they alternate. Their correlation is -1/2
/// if errors accumulate (each frame's error is the last one's plus a random part), and -2/3 if
/// errors are independent.
struct TrackNoise {
  bool moves = false;
  double correlation = 0.0;  ///< Correlation of neighbouring changes.
  double sharp_correlation =
      0.0;  ///< Correlation of neighbouring differences of changes; at most -2/3 for noise.
  double step = 0.0;  ///< RMS change of the error per frame, rad or length.
  /// Acceleration of the movement over 0.2 s to either side, without the contribution of noise:
  /// RMS, per frame squared.
  double acceleration = 0.0;

  /// Returns whether the track has certain noise of more than this per frame.
  [[nodiscard]] bool exceeds(double step_limit) const;
  /// Weaker test for a track among noisy ones: fast movement hides noise from the changes.
  [[nodiscard]] bool may_exceed(double step_limit) const;
};

/// Limits for rotations, rad: harmful to a robot's motion, and noise where other joints are noisy.
inline constexpr double kLargeStep = 0.3 * 3.14159265358979 / 180.0, kSmallStep = kLargeStep / 3.0;

/// @param rotations  neighbours have a dot product >= 0.
[[nodiscard]] TrackNoise measure_noise(const std::vector<Eigen::Quaterniond>& rotations,
                                       double frame_time);
[[nodiscard]] TrackNoise measure_noise(const std::vector<Eigen::Vector3d>& places,
                                       double frame_time);

/// Returns the frequency in Hz, from `slowest` to 6, at which movement and noise are equally
/// strong.
[[nodiscard]] double cutoff_for(const TrackNoise& noise, double frame_time, double slowest);

/// Applies a zero-phase low-pass filter.
/// @param rotations  neighbours have a dot product >= 0.
[[nodiscard]] std::vector<Eigen::Quaterniond> smoothed(std::vector<Eigen::Quaterniond> rotations,
                                                       double cutoff, double frame_time);
[[nodiscard]] std::vector<Eigen::Vector3d> smoothed(std::vector<Eigen::Vector3d> places,
                                                    double cutoff, double frame_time);

}  // namespace retarget
