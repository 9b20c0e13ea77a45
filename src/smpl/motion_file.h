#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "smpl/array_source.h"
#include "smpl/motion_arrays.h"

namespace retarget {

/// An SMPL motion's file, opened: where its arrays are, and what its kind tells beside them.
struct MotionFile {
  std::unique_ptr<ArraySource> arrays;
  MotionKind kind;
  std::vector<Warning> warnings;
};

/// Whether bytes can only be an SMPL motion (or a file that is none, which open_motion_file tells
/// better than others): archives, arrays of NumPy, pickles.
[[nodiscard]] bool looks_like_motion_file(std::string_view bytes);

/// Opens a file by its content: NPZ; PyTorch's archives (GVHMR's results, InterMimic's tensors,
/// dictionaries with the arrays of an NPZ); pickles of such dictionaries; single arrays of NumPy
/// (Motion-X, PHUMA).
///
/// Errors: the readers' own; contents that are no motion of SMPL, told in one sentence.
/// @param bytes             the whole file; must outlive the result.
/// @param max_number_bytes  of an array's numbers as doubles; more are refused.
[[nodiscard]] Result<MotionFile> open_motion_file(std::string_view bytes,
                                                  const std::string& file_name,
                                                  std::size_t max_number_bytes);

/// The same for a single array of NumPy. @param bytes  begins like one
[[nodiscard]] Result<MotionFile> open_array_motion(std::string_view bytes,
                                                   const std::string& file_name,
                                                   std::size_t max_number_bytes);

}  // namespace retarget
