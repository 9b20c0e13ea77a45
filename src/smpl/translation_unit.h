#pragma once

#include <optional>
#include <string>

#include "smpl/motion_arrays.h"
#include "smpl/smpl_body.h"

namespace retarget {

/// A unit that `trans` is in instead of metres.
struct TranslationUnit {
  double metres = 1.0;
  std::string reason;  ///< A sentence for the user.
};

/// Finds out by figures over the whole clip that `trans` is in centimetres or millimetres. The body
/// is in metres, and one of its feet is nearly always still. So the unit shows where the slower foot
/// would be faster than any human gets, half of the time, and is not so in the other unit; or where
/// the lowest foot would be ten metres and more above or below 0 and is at 0 in the other.
/// @return nothing: metres, or no other unit explains the figures better.
[[nodiscard]] std::optional<TranslationUnit> find_translation_unit(const MotionArrays& arrays,
                                                                   const SmplRestBody& body);

}  // namespace retarget
