#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "retarget/clip.h"
#include "retarget/options.h"
#include "retarget/so3.h"
#include "retarget/spline.h"
#include "retarget/time_scale.h"

namespace retarget {

/// Makes a track sign-continuous: replaces q by -q where that is nearer to the previous rotation.
inline void make_sign_continuous(std::vector<Eigen::Quaterniond>& track) {
  for (std::size_t i = 1; i < track.size(); ++i) {
    align_sign(track[i - 1].coeffs(), track[i].coeffs());
  }
}

inline void make_sign_continuous(std::vector<Eigen::Vector3d>&) {}

/// The rotations (Eigen::Quaterniond) or translations (Eigen::Vector3d) of one joint as a function
/// of time. Quaternions are sign-continuous. For cubic interpolation, it stores a velocity per
/// frame, so that each sample takes constant time.
template <typename Value>
class TrackSampler {
 public:
  TrackSampler(std::vector<Value> track, Interpolation interpolation) : track_(std::move(track)) {
    make_sign_continuous(track_);
    if (interpolation == Interpolation::kCubic && !track_.empty()) {
      velocities_ = spline_velocities(steps_between(track_));
    }
  }

  /// Value at `fraction` in [0, 1) between `frame` and the next frame. A fraction of zero, or any
  /// fraction at the last frame, gives the frame itself bit for bit.
  /// @pre frame is one of the track's.
  [[nodiscard]] Value sample(int frame, double fraction) const {
    const auto at = static_cast<std::size_t>(frame);
    if (fraction == 0.0 || at + 1 == track_.size()) return track_[at];
    if (velocities_.empty()) {
      return interpolate_linear(track_[at], track_[at + 1], fraction);
    }
    return interpolate_cubic(track_[at], velocities_[at], track_[at + 1], velocities_[at + 1],
                             fraction);
  }

 private:
  std::vector<Value> track_;
  std::vector<Eigen::Vector3d> velocities_;  // Change per frame; empty for linear interpolation.
};

/// The times of a motion whose source is slowed down by a TimeScale.
class TimeWarp {
 public:
  /// @param duration  duration of the source, seconds.
  TimeWarp(const TimeScale& scale, double duration);

  /// Seconds of the motion per second of the source, at a time of the source in seconds.
  [[nodiscard]] double pace(double source) const;
  /// Time of the motion for a time of the source, seconds; exact integral of the pace.
  [[nodiscard]] double motion_time(double source) const;
  /// Its inverse.
  [[nodiscard]] double source_time(double motion) const;
  /// Duration of the motion, seconds.
  [[nodiscard]] double duration() const { return motion_time(duration_); }

 private:
  [[nodiscard]] const double* piece(std::size_t knot) const { return pace_.data() + knot; }
  [[nodiscard]] std::size_t knot_before(double source) const;

  double knot_time_, duration_;
  std::vector<double> pace_;   // Coefficients.
  std::vector<double> times_;  // Times of the motion at the knots.
};

/// A time between a frame of the source and the next one.
struct WarpedFrame {
  int frame = 0;
  double share = 0.0;  ///< Fraction of the time to the next frame, in [0, 1).
};

/// The source times of all frames of the slowed motion; both have the same rate. Times within
/// 1e-9 of a frame are that frame, so a slower interval does not change the frames before it.
[[nodiscard]] std::vector<WarpedFrame> warped_frames(const TimeScale& scale, const FrameRate& rate,
                                                     int frame_count);

/// Number of frames of the slowed motion.
[[nodiscard]] std::int64_t warped_frame_count(const TimeScale& scale, const FrameRate& rate,
                                              std::int64_t frame_count);

/// Stretches the time of a clip and keeps its rate. Between frames, rotations and translations
/// follow the splines of TrackSampler.
[[nodiscard]] Clip warp_time(const Clip& clip, const TimeScale& scale);

}  // namespace retarget
