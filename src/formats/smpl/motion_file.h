#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "formats/containers/array_source.h"
#include "formats/smpl/motion_arrays.h"

namespace retarget {

/// Kind of data in a motion file.
enum class MotionContent : std::uint8_t {
  kSmpl,    ///< Rotations of SMPL's joints. Also used for unknown content, which the SMPL reader
            ///< reports.
  kJoints,  ///< Joint positions: read_joint_motion.
};

/// An opened motion file: its arrays and the facts that follow from its kind.
struct MotionFile {
  std::unique_ptr<ArraySource> arrays;
  MotionKind kind;
  std::vector<Warning> warnings;
  MotionContent content = MotionContent::kSmpl;
  bool took = false;  ///< The motion is one of several, selected by OpenOptions::take.
};

struct OpenOptions {
  /// Limit on the memory of an array after conversion to double.
  std::size_t max_number_bytes = std::numeric_limits<std::size_t>::max();
  std::string take;  ///< One of several motions, by name or number from 1; empty: the only one.
  bool has_names = false;  ///< Joint names are given, so a 2-D table may hold joint positions.
};

/// Opens a file and detects its type by content: NPZ; PyTorch archives (GVHMR results, InterMimic
/// tensors, dictionaries with the arrays of an NPZ); pickles of such dictionaries, also as written
/// by numpy.save; single NumPy arrays (Motion-X, PHUMA, joint positions).
///
/// Errors: those of the file readers, and one-sentence errors for content that is not a human
/// motion.
/// @param bytes  the whole file; must outlive the result.
[[nodiscard]] Result<MotionFile> open_motion_file(std::string_view bytes,
                                                  const std::string& file_name,
                                                  const OpenOptions& options = {});

/// open_motion_file for a single NumPy array. @param bytes  begin with NumPy's magic number
[[nodiscard]] Result<MotionFile> open_array_motion(std::string_view bytes,
                                                   const std::string& file_name,
                                                   const OpenOptions& options);

/// open_motion_file for a pickle. @param bytes  begin like a pickle
[[nodiscard]] Result<MotionFile> open_pickled_motion(std::string_view bytes,
                                                     const std::string& file_name,
                                                     const OpenOptions& options);

/// Number of columns of InterMimic's motions.
inline constexpr std::size_t kInterMimicColumns = 591;

/// A motion in the column layout of InterMimic's and holosoma's loaders (OMOMO among the data).
/// Columns 0 to 2: pelvis position in metres, Z up. 3 to 6: pelvis rotation, quaternion x y z w. 9
/// to 161: rotation vectors of 51 joints in MuJoCo's order (depth first), in axes with x forward, y
/// left, z up. 162 to 317: positions of all 52 bodies. The remaining columns (object, contacts) are
/// not read.
struct InterMimicMotion {
  std::unique_ptr<ArraySource> arrays;  ///< `poses` (F, 66) and `trans` (F, 3) in SMPL's
                                        ///< convention.
  MotionKind kind;  ///< 30 fps; its body has the bone lengths given by the positions.
};

/// Converts a table of shape (F, 591).
/// Errors: no frames, numbers that are not finite, or rotations and positions that disagree by more
/// than a centimetre, which means that the columns hold other data.
[[nodiscard]] Result<InterMimicMotion> read_intermimic(const NpyArray& table,
                                                       const std::string& file_name);

}  // namespace retarget
