#include "retarget/motion/resample.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "motion/clip_tracks.h"
#include "retarget/math/filter.h"

namespace retarget {
namespace {

// frame numbers times the terms of two rates pass 64 bits
__extension__ using Int128 = __int128;

constexpr std::int64_t kLargestUpsampling = 1000;
constexpr std::int64_t kLargestFrameCount = 10'000'000;
// one part of an output sample that still counts as reached
constexpr std::int64_t kParts = 1'000'000'000;

// source frames per output sample as a fraction
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
  const bool too_dense = stride.numerator * kLargestUpsampling < stride.denominator;
  if (source.frame_count() < 2 || (!too_dense && output_count <= kLargestFrameCount)) return {};
  return input_failure("",
                       "going from " + to_text(source.rate()) + " to " + to_text(output_rate) +
                           " fps would make " + std::to_string(output_count) + " frames out of " +
                           std::to_string(source.frame_count()),
                       "one of the two rates is wrong; give the true ones");
}

// without what the output rate cannot show; signs must be continuous
Clip damped(const Clip& source, double ratio) {
  const std::vector<double> taps = anti_alias_taps(ratio);
  Clip filtered = source;
  for (int joint = 0; joint < source.skeleton().joint_count(); ++joint) {
    const auto track = low_pass(rotation_track(source, joint), taps);
    for (int frame = 0; frame < source.frame_count(); ++frame) {
      filtered.rotations(frame)[joint] = track[frame];
    }
  }
  for (int slot = 0; slot < source.skeleton().translated_count(); ++slot) {
    const auto track = low_pass(translation_track(source, slot), taps);
    for (int frame = 0; frame < source.frame_count(); ++frame) {
      filtered.translations(frame)[slot] = track[frame];
    }
  }
  return filtered;
}

}  // namespace

std::int64_t resampled_frame_count(int frame_count, const FrameRate& source_rate,
                                   const FrameRate& output_rate) {
  if (frame_count < 1) return 0;
  const Stride stride(source_rate, output_rate);
  const Int128 length = Int128{frame_count - 1} * stride.denominator;
  const Int128 count = (length * kParts + stride.numerator) / (stride.numerator * kParts) + 1;
  constexpr Int128 kMost = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(std::min(count, kMost));
}

Result<Clip> resample(const Clip& source, const FrameRate& output_rate,
                      const ResampleOptions& options) {
  if (same_rate(source.rate(), output_rate)) {
    Clip copy = source;
    copy.set_rate(output_rate);
    return copy;
  }
  const std::int64_t count =
      resampled_frame_count(source.frame_count(), source.rate(), output_rate);
  if (auto fits = check_size(source, output_rate, count); !fits) return failure(fits.error());

  const Stride stride(source.rate(), output_rate);
  Clip continuous = source;
  make_sign_continuous(continuous);
  const bool decimates = stride.numerator > stride.denominator;
  const ClipSampler sampler(
      decimates && options.antialias ? damped(continuous, stride.value()) : std::move(continuous),
      options.interpolation);

  Clip output(source.shared_skeleton(), output_rate, static_cast<int>(count));
  const Int128 last = source.frame_count() - 1;
  for (int i = 0; i < output.frame_count(); ++i) {
    const Int128 place = i * stride.numerator;
    // the last sample may be a hair behind the last frame
    const auto frame = static_cast<int>(std::min(place / stride.denominator, last));
    const double fraction =
        static_cast<double>(place % stride.denominator) / static_cast<double>(stride.denominator);
    sampler.sample(frame, fraction, output.rotations(i), output.translations(i));
  }
  return output;
}

}  // namespace retarget
