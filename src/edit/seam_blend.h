#pragma once

#include "edit/concatenate.h"
#include "edit/find_seam.h"
#include "retarget/clip.h"

namespace retarget {

/// How two clips share the frames around their seam, in frames of the result.
struct SeamRegion {
  int begin = 0, end = 0;  ///< Frames that neither clip has as they are.
  int a_end = 0;           ///< a counts in the frames before this one;
  int b_begin = 0;         ///< b from this one on,
  int b_shift = 0;         ///< whose frame f is frame f + b_shift.

  /// Weight of a in a frame.
  [[nodiscard]] double weight_of_a(int frame) const;
};

[[nodiscard]] SeamRegion seam_region(const Seam& seam, const ConcatenateOptions& options,
                                     const FrameRate& rate, int frames_of_b);

/// The clips as one; b lies already where it is to go on.
/// @param mover  of their skeleton.
[[nodiscard]] Clip blend_clips(const Clip& a, const Clip& b, const SeamRegion& region,
                               const HumanMapping& mapping, const BodyMover& mover);

}  // namespace retarget
