#pragma once

#include <optional>
#include <string>

#include "formats/containers/array_source.h"
#include "formats/smpl/motion_arrays.h"
#include "formats/smpl/smpl_body.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// A unit of `trans` other than metres.
struct TranslationUnit {
  double metres = 1.0;
  std::string reason;  ///< A sentence for the user.
};

/// Detects from statistics of the whole clip that `trans` is in centimetres or millimetres. The
/// body is in metres, and one of its feet is nearly always at rest. Another unit is evident if, in
/// metres, the slower foot exceeds human speed in half of the frames but not in the other unit; or
/// if, in metres, the lowest foot is ten metres or more away from height 0 but near 0 in the other
/// unit.
/// @return nothing for metres, or if no other unit explains the data better.
[[nodiscard]] std::optional<TranslationUnit> find_translation_unit(const MotionArrays& arrays,
                                                                   const SmplRestBody& body);

/// Reads the frame rate of a motion file from any of its known names. Returns nothing without
/// one. Errors: two different rates, an invalid rate.
/// @param source_fps  overrides the file's rate, Hz; positive and finite.
[[nodiscard]] Result<std::optional<FrameRate>> read_motion_rate(const ArraySource& file,
                                                                std::optional<double> source_fps);

/// The error for a file without a rate whose kind has no usual one.
[[nodiscard]] Failure no_motion_rate(const ArraySource& file);

}  // namespace retarget
