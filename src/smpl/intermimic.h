#pragma once

#include <memory>

#include "smpl/array_source.h"
#include "smpl/motion_arrays.h"

namespace retarget {

/// Width of InterMimic's motions.
inline constexpr std::size_t kInterMimicColumns = 591;

/// A motion in the columns that InterMimic's loaders and holosoma read (OMOMO among them): 0 to 2 the
/// pelvis's place in metres, Z up; 3 to 6 its rotation, a quaternion x y z w; 9 to 161 the rotation
/// vectors of 51 joints in MuJoCo's order, depth first, in axes with x forward, y to the left and z
/// up; 162 to 317 the places of all 52 bodies. What follows tells of an object and of contacts, and
/// is not read.
struct InterMimicMotion {
  std::unique_ptr<ArraySource> arrays;  ///< `poses` (F, 66), `trans` (F, 3) as SMPL has them.
  MotionKind kind;                      ///< 30 fps; the body, whose bones the places give.
};

/// @param table  (F, 591) numbers.
/// Errors: no frames, numbers that are not finite, rotations and places that disagree by more than a
/// centimetre, so that the columns are something else.
[[nodiscard]] Result<InterMimicMotion> read_intermimic(const NpyArray& table,
                                                       const std::string& file_name);

}  // namespace retarget
