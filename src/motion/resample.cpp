#include "motion/resample.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/math/uniform_spline.h"
#include "base/try.h"
#include "motion/clip.h"
#include "retarget/filter.h"
#include "retarget/resample.h"

namespace retarget {
namespace {

// Products of a frame number and the terms of two rates exceed 64 bits.
__extension__ using Int128 = __int128;

constexpr std::int64_t kMaxUpsampling = 1000;
constexpr std::int64_t kMaxFrameCount = 10'000'000;
// A clip with more than kSparse samples per source frame must not exceed this size. Otherwise, a
// few kilobytes of text could expand to gigabytes.
constexpr std::int64_t kSparse = 4;
constexpr std::int64_t kMaxSparseBytes = std::int64_t{64} << 20;
// Tolerance for the last output sample: one part of this many.
constexpr std::int64_t kParts = 1'000'000'000;

// Source frames per output sample, as a fraction.
struct Stride {
  Int128 numerator;
  Int128 denominator;

  Stride(const FrameRate& source, const FrameRate& output)
      : numerator(Int128{source.frames} * output.seconds),
        denominator(Int128{source.seconds} * output.frames) {}

  [[nodiscard]] double value() const {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
};

Result<void> check_size(const Clip& source, const FrameRate& output_rate,
                        std::int64_t output_count) {
  const Stride stride(source.rate(), output_rate);
  const bool sparse = stride.numerator * kSparse < stride.denominator;
  const auto max_sparse =
      kMaxSparseBytes / static_cast<std::int64_t>(frame_bytes(source.skeleton()));
  const bool too_dense = stride.numerator * kMaxUpsampling < stride.denominator ||
                         (sparse && output_count > max_sparse);
  if (source.frame_count() < 2 || (!too_dense && output_count <= kMaxFrameCount)) return {};
  return input_failure("",
                       "resampling from " + to_text(source.rate()) + " to " + to_text(output_rate) +
                           " fps would make " + std::to_string(output_count) + " frames from " +
                           std::to_string(source.frame_count()),
                       "one of the two rates is wrong; give the correct rates");
}

// Resamples the tracks of one clip, independently of each other.
class TrackResampler {
 public:
  TrackResampler(const Clip& source, int count, const Stride& stride,
                 const ResampleOptions& options)
      : last_(source.frame_count() - 1),
        count_(count),
        stride_(stride),
        interpolation_(options.interpolation) {
    const bool decimates = stride.numerator > stride.denominator;
    if (decimates && options.antialias) taps_ = anti_alias_taps(stride.value());
  }

  template <typename Value>
  std::vector<Value> resample(std::vector<Value> track) const {
    make_sign_continuous(track);
    if (stride_.numerator % stride_.denominator == 0) return pick(track);
    // Removes frequencies that the output rate cannot represent.
    if (!taps_.empty()) track = low_pass(track, taps_);
    const TrackSampler<Value> sampler(std::move(track), interpolation_);
    std::vector<Value> samples;
    samples.reserve(count_);
    for (int i = 0; i < count_; ++i) {
      const Int128 place = i * stride_.numerator;
      // The last sample may lie slightly after the last frame.
      const auto frame = static_cast<int>(std::min(place / stride_.denominator, last_));
      const double fraction = static_cast<double>(place % stride_.denominator) /
                              static_cast<double>(stride_.denominator);
      samples.push_back(sampler.sample(frame, fraction));
    }
    return samples;
  }

 private:
  // Every sample falls on a frame, so only these frames need filtering.
  template <typename Value>
  std::vector<Value> pick(const std::vector<Value>& track) const {
    const auto stride = static_cast<std::size_t>(stride_.numerator / stride_.denominator);
    std::vector<Value> samples;
    if (taps_.empty()) {
      for (std::size_t i = 0; i < track.size(); i += stride) samples.push_back(track[i]);
    } else {
      samples = low_pass(track, taps_, stride);
    }
    make_sign_continuous(samples);
    return samples;
  }

  const Int128 last_;
  const int count_;
  const Stride stride_;
  const Interpolation interpolation_;
  std::vector<double> taps_;  // Empty: no filter.
};

}  // namespace

std::int64_t resampled_frame_count(int frame_count, const FrameRate& source_rate,
                                   const FrameRate& output_rate) {
  if (frame_count < 1) return 0;
  const Stride stride(source_rate, output_rate);
  const Int128 length = Int128{frame_count - 1} * stride.denominator;
  const Int128 count = (length * kParts + stride.numerator) / (stride.numerator * kParts) + 1;
  constexpr Int128 kMaxInt64 = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(std::min(count, kMaxInt64));
}

Result<Clip> resample(Clip source, const FrameRate& output_rate, const ResampleOptions& options) {
  if (same_rate(source.rate(), output_rate)) {
    source.set_rate(output_rate);
    return source;
  }
  const std::int64_t count =
      resampled_frame_count(source.frame_count(), source.rate(), output_rate);
  TRY(check_size(source, output_rate, count));

  // Works joint by joint to avoid a second copy of a long clip.
  const TrackResampler tracks(source, static_cast<int>(count), Stride(source.rate(), output_rate),
                              options);
  Clip output = source.empty_like(output_rate, static_cast<int>(count));
  change_tracks(source, output, [&](auto track) { return tracks.resample(std::move(track)); });
  return output;
}

double TimeScale::least_factor() const {
  double least = 1.0;
  for (const SlowedStretch& stretch : stretches) least = std::min(least, stretch.factor);
  return least;
}

double constant_pace(const std::optional<TimeScale>& scale) {
  if (!scale || scale->pace.empty()) return 1.0;
  const std::vector<double>& pace = scale->pace;
  const bool varies = std::ranges::adjacent_find(pace, std::not_equal_to<>()) != pace.end();
  return varies ? 1.0 : pace.front();
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
  change_tracks(clip, output, [&](auto track) {
    const TrackSampler sampler(std::move(track), Interpolation::kCubic);
    decltype(track) samples;
    for (const WarpedFrame& each : frames) {
      samples.push_back(sampler.sample(each.frame, each.share));
    }
    return samples;
  });
  make_sign_continuous(output);
  return output;
}

}  // namespace retarget
