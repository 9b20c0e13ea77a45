#include "motion/time_warp.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/math/uniform_spline.h"
#include "motion/clip.h"
#include "motion/resample.h"
#include "retarget/options.h"

namespace retarget {
double TimeScale::least_factor() const {
  double least = 1.0;
  for (const SlowedStretch& stretch : stretches) least = std::min(least, stretch.factor);
  return least;
}

TimeWarp::TimeWarp(const TimeScale& scale, double duration)
    : knot_time_(scale.knot_time), duration_(duration), pace_(scale.pace) {
  const auto pieces = static_cast<std::size_t>(std::max(1.0, std::ceil(duration / knot_time_)));
  pace_.resize(pieces + 3, 1.0);
  times_.push_back(0.0);
  for (std::size_t knot = 0; knot < pieces; ++knot) {
    times_.push_back(times_.back() + knot_time_ * UniformCubic(piece(knot)).integral(1.0));
  }
}

std::size_t TimeWarp::knot_before(double source) const {
  const double knot = std::floor(std::max(0.0, source) / knot_time_);
  return std::min(static_cast<std::size_t>(knot), times_.size() - 2);
}

double TimeWarp::pace(double source) const {
  const std::size_t knot = knot_before(source);
  return UniformCubic(piece(knot)).value(source / knot_time_ - static_cast<double>(knot));
}

double TimeWarp::motion_time(double source) const {
  const std::size_t knot = knot_before(source);
  return times_[knot] +
         knot_time_ *
             UniformCubic(piece(knot)).integral(source / knot_time_ - static_cast<double>(knot));
}

double TimeWarp::source_time(double motion) const {
  const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, motion);
  const auto knot = static_cast<std::size_t>(after - times_.begin()) - 1;
  const UniformCubic p(piece(knot));
  const double wanted = (motion - times_[knot]) / knot_time_;
  // The pace is at least 1, so the integral rises and Newton's steps are safe within its bounds.
  double low = 0.0, high = std::max(1.0, wanted), s = std::min(wanted, 1.0);
  for (int step = 0; step < 60; ++step) {
    const double rest = p.integral(s) - wanted;
    if (rest == 0.0) break;
    (rest > 0.0 ? high : low) = s;
    double next = s - rest / p.value(s);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - s) <= 1e-15) break;
    s = next;
  }
  return knot_time_ * (static_cast<double>(knot) + s);
}

std::vector<WarpedFrame> warped_frames(const TimeScale& scale, const FrameRate& rate,
                                       int frame_count) {
  constexpr double kSame = 1e-9;
  std::vector<WarpedFrame> frames;
  const std::int64_t count = warped_frame_count(scale, rate, frame_count);
  const TimeWarp warp(scale, rate.time_of(std::max(0, frame_count - 1)));
  for (std::int64_t i = 0; i < count; ++i) {
    const double place = std::clamp(warp.source_time(rate.time_of(i)) * rate.fps(), 0.0,
                                    static_cast<double>(frame_count - 1));
    const double nearest = std::round(place);
    if (std::abs(place - nearest) < kSame) {
      frames.push_back({static_cast<int>(nearest), 0.0});
    } else {
      frames.push_back({static_cast<int>(std::floor(place)), place - std::floor(place)});
    }
  }
  return frames;
}

std::int64_t warped_frame_count(const TimeScale& scale, const FrameRate& rate,
                                std::int64_t frame_count) {
  if (frame_count < 2) return frame_count;
  const TimeWarp warp(scale, rate.time_of(frame_count - 1));
  return static_cast<std::int64_t>(std::floor(warp.duration() * rate.fps() + 1e-6)) + 1;
}

Clip warp_time(const Clip& clip, const TimeScale& scale) {
  const std::vector<WarpedFrame> frames = warped_frames(scale, clip.rate(), clip.frame_count());
  Clip output = clip.empty_like(clip.rate(), static_cast<int>(frames.size()));
  for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
    const TrackSampler<Eigen::Quaterniond> track(rotation_track(clip, joint),
                                                 Interpolation::kCubic);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      output.rotations(static_cast<int>(i))[static_cast<std::size_t>(joint)] =
          track.sample(frames[i].frame, frames[i].share);
    }
  }
  for (int slot = 0; slot < clip.skeleton().translated_count(); ++slot) {
    const TrackSampler<Eigen::Vector3d> track(translation_track(clip, slot), Interpolation::kCubic);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      output.translations(static_cast<int>(i))[static_cast<std::size_t>(slot)] =
          track.sample(frames[i].frame, frames[i].share);
    }
  }
  make_sign_continuous(output);
  return output;
}

}  // namespace retarget
