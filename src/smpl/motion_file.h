#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "smpl/array_source.h"
#include "smpl/motion_arrays.h"

namespace retarget {

/// What the arrays of a motion's file tell.
enum class MotionContent : std::uint8_t {
  kSmpl,    ///< Rotations of SMPL's joints; also where nothing is known, which its reader tells.
  kJoints,  ///< Places of joints: read_joint_motion.
};

/// A motion's file, opened: where its arrays are, and what its kind tells beside them.
struct MotionFile {
  std::unique_ptr<ArraySource> arrays;
  MotionKind kind;
  std::vector<Warning> warnings;
  MotionContent content = MotionContent::kSmpl;
  bool took = false;  ///< One of several motions in the file, as OpenOptions::take says.
};

struct OpenOptions {
  /// Of an array's numbers as doubles; more are refused.
  std::size_t max_number_bytes = std::numeric_limits<std::size_t>::max();
  std::string take;        ///< Which of several motions, by name or number from 1; empty: the only
                           ///< one.
  bool has_names = false;  ///< Names of joints are given, so that tables may be places of joints.
};

/// Whether bytes can only be such a motion (or a file that is none, which open_motion_file tells
/// better than others): archives, arrays of NumPy, pickles.
[[nodiscard]] bool looks_like_motion_file(std::string_view bytes);

/// Opens a file by its content: NPZ; PyTorch's archives (GVHMR's results, InterMimic's tensors,
/// dictionaries with the arrays of an NPZ); pickles of such dictionaries, also those that numpy.save
/// makes; single arrays of NumPy (Motion-X, PHUMA, places of joints).
///
/// Errors: the readers' own; contents that are no motion of a human, told in one sentence.
/// @param bytes  the whole file; must outlive the result.
[[nodiscard]] Result<MotionFile> open_motion_file(std::string_view bytes,
                                                  const std::string& file_name,
                                                  const OpenOptions& options = {});

/// The same for a single array of NumPy. @param bytes  begins like one
[[nodiscard]] Result<MotionFile> open_array_motion(std::string_view bytes,
                                                   const std::string& file_name,
                                                   const OpenOptions& options);

/// The same for a pickle. @param bytes  begins like one
[[nodiscard]] Result<MotionFile> open_pickled_motion(std::string_view bytes,
                                                     const std::string& file_name,
                                                     const OpenOptions& options);

}  // namespace retarget
