#pragma once

#include <optional>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

struct BvhWriteOptions {
  /// Decimals of offsets, positions and angles, 0 to 17. Without: as many as it takes to read the
  /// same doubles again. The frame time always has as many as it takes.
  std::optional<int> decimals;
};

/// The clip as BVH text, lines ended by LF, in any locale.
///
/// Each joint's channels are written as its skeleton lists them, rotations in the joint's own
/// order in degrees. Of the angles that give a rotation those nearest to the frame before are
/// taken (in the first frame: nearest to 0), so that curves do not jump. Scale channels are 1.
/// Reading the text gives the same rotations, translations and offsets to 1e-9 (without
/// `decimals`); a quaternion may come back as its negative.
///
/// @return ErrorKind::kRun errors, naming joint and frame, for what BVH cannot say: values that
///     are not finite, a rotation that the joint's channels do not reach (fewer than three
///     different turns), a translation along an axis without a position channel that is not the
///     offset's, names that are empty or hold line ends or `{`, frames without any channel,
///     joints that are not in depth-first order.
[[nodiscard]] Result<std::string> format_bvh(const Clip& clip, const BvhWriteOptions& options = {});

/// format_bvh into a file, whole or not at all; `-` is standard output.
[[nodiscard]] Result<void> save_bvh(const std::string& path, const Clip& clip,
                                    const BvhWriteOptions& options = {});

}  // namespace retarget
