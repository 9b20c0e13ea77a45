#pragma once

#include <cstdint>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

struct ResampleOptions {
  Interpolation interpolation = Interpolation::kCubic;
  /// Damp what the output rate cannot show before going to a lower rate; see anti_alias_taps.
  bool antialias = true;
};

/// How many frames at `output_rate` a clip of `frame_count` frames at `source_rate` has:
/// floor(duration * output fps + 1e-9) + 1, the duration being (frame_count - 1) / source rate,
/// in whole numbers; none for none. The last sample may lie before the last source frame, never
/// after it by more than the 1e-9 of a sample.
/// @pre frame_count >= 0; the terms of the rates are at most 1e9, as frame_rate_from_fps makes them
[[nodiscard]] std::int64_t resampled_frame_count(int frame_count, const FrameRate& source_rate,
                                                 const FrameRate& output_rate);

/// The clip at another frame rate. Sample i is at time i / output rate, the first at 0; the place
/// of each among the source frames is found in whole numbers, so nothing drifts.
///
/// Rates that are equal within 1e-4 (same_rate) count as one: every frame is kept as it is, bit
/// for bit, and the clip takes the output's rate. Otherwise quaternions are made sign-continuous
/// (so they are in the result), a clip going to a lower rate is low-pass filtered first
/// (zero-phase; rotations by their components, see low_pass), and samples between frames are
/// interpolated. Samples that fall on a frame take it bit for bit; going to a whole fraction of
/// the rate without the filter therefore picks frames.
///
/// Input errors: more than 1000 samples between two frames, more than 10 million in all, or more
/// than four between two frames and 64 MB in all; a frame rate like that is a slip, and following
/// it would fill the memory.
[[nodiscard]] Result<Clip> resample(Clip source, const FrameRate& output_rate,
                                    const ResampleOptions& options = {});

}  // namespace retarget
