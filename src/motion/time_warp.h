#pragma once

#include <vector>

#include "retarget/clip.h"
#include "retarget/time_scale.h"

namespace retarget {

/// The times of a motion whose source is slowed down by a TimeScale.
class TimeWarp {
 public:
  /// @param duration  of the source, seconds.
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

/// Stretches the time of a clip; its rate stays. Between frames, rotations and translations follow
/// the splines of TrackSampler.
[[nodiscard]] Clip warp_time(const Clip& clip, const TimeScale& scale);

}  // namespace retarget
