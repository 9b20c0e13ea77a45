#pragma once

#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Repairs a clip whose units are inconsistent, as its feet show: a standing or walking body rests
/// on one of its ankles or toes, whose speed is measured in legs (thigh plus shin) per second.
///
/// * Rotations in radians that were read as degrees: no joint turns by more than about 2 pi of them
///   (the root by six times this), trunk and legs point apart when read as radians, and either the
///   slowest foot is less than half as fast in radians, or trunk and legs point the same way in
///   degrees. They are converted.
/// * A root translation in another unit than the OFFSETs: with the translation multiplied by the
///   ratio of two units, the slowest foot is less than 0.4 times as fast, and less than half as
///   fast as without any translation. It is converted.
///
/// Uncertain cases stay unchanged: a scale that is not a ratio of two units, and a root that does
/// not move while the feet do.
/// @return one warning per change or uncertain assumption
[[nodiscard]] std::vector<Warning> mend_clip_units(Clip& clip, const BoneMap& map);

}  // namespace retarget
