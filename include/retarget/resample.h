#pragma once

#include <cstdint>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"
#include "retarget/options.h"

namespace RETARGET_API retarget {

/// How frames are interpolated and filtered.
struct ResampleOptions {
  Interpolation interpolation = Interpolation::kCubic;
  /// Whether to filter out frequencies that a lower output rate cannot represent.
  bool antialias = true;
};

/// Number of frames at `output_rate` of a clip with `frame_count` frames at `source_rate`:
/// floor(duration * output fps + 1e-9) + 1 with duration = (frame_count - 1) / source rate,
/// computed in integers; 0 for an empty clip. The last sample may lie before the last source frame,
/// but at most 1e-9 of a sample after it.
/// @pre frame_count >= 0; the terms of the rates are at most 1e9, as from frame_rate_from_fps.
[[nodiscard]] std::int64_t resampled_frame_count(int frame_count, const FrameRate& source_rate,
                                                 const FrameRate& output_rate);

/// Resamples a clip. Sample i is at time i / output rate, the first at 0. Its position among the
/// source frames is computed in integers, so there is no drift.
///
/// Rates that agree within 1e-4 (same_rate) count as equal: all frames are kept bit for bit, and
/// the clip takes the output rate. Otherwise, quaternions are made sign-continuous (also in the
/// result), a clip that goes to a lower rate is low-pass filtered first (zero-phase; rotations by
/// their components), and samples between frames are interpolated. Samples at the
/// time of a frame equal it bit for bit, so without the filter, an output rate that divides the
/// source rate selects frames.
///
/// Input errors: more than 1000 samples between two frames, more than 10 million in total, or more
/// than four between two frames and 64 MB in total. Such a rate is a mistake and would exhaust the
/// memory.
[[nodiscard]] Result<Clip> resample(Clip source, const FrameRate& output_rate,
                                    const ResampleOptions& options = {});

/// Resamples a robot motion to another frame rate, as resample() does for clips: root position and
/// joint positions as scalar tracks, the root's rotation as quaternions; sample i is at time i /
/// output rate. A joint that is inside the robot's default limits in all frames stays inside.
[[nodiscard]] Result<RobotClip> resample_robot(const RobotClip& source,
                                               const FrameRate& output_rate,
                                               const ResampleOptions& options = {});

}  // namespace retarget
