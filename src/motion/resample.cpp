#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/try.h"
#include "motion/clip.h"
#include "motion/resample.h"
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
  for (int joint = 0; joint < source.skeleton().joint_count(); ++joint) {
    const auto track = tracks.resample(rotation_track(source, joint));
    for (int i = 0; i < output.frame_count(); ++i) output.rotations(i)[joint] = track[i];
  }
  for (int slot = 0; slot < source.skeleton().translated_count(); ++slot) {
    const auto track = tracks.resample(translation_track(source, slot));
    for (int i = 0; i < output.frame_count(); ++i) output.translations(i)[slot] = track[i];
  }
  return output;
}

}  // namespace retarget
