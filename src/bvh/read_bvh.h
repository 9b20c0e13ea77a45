#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

struct BvhReadOptions {
  /// Keep the complete rows of a damaged file (cut off, bad numbers, NaN, rows of a wrong length)
  /// and say in a warning what was left out. A file without any complete row stays an error, as
  /// do faults before the rows.
  bool lenient = false;

  /// Accept a file that ends before MOTION: a skeleton without frames. What is there of MOTION is
  /// checked as ever.
  bool motion_optional = false;

  /// Frames per second in place of the header's frame time, which may then be missing or 0.
  std::optional<double> source_fps;

  /// Bytes that the clip may take in memory; a file whose clip would take more is an error. A
  /// skeleton can be much larger than its rows, so whatever this says, a clip takes at most
  /// kMaxBytesOfText times the bytes of the text, where that is more than kFreeClipBytes.
  std::size_t max_clip_bytes = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t kMaxBytesOfText = 64;
  static constexpr std::size_t kFreeClipBytes = std::size_t{32} << 20;

  /// The tree to take, by the name of its root, where a file holds several; the only one if empty.
  std::string root;
};

/// A BVH file: the motion, and what its text said beside it.
struct BvhFile {
  /// Lengths and axes as in the file. Joint names are the file's bytes: without control bytes,
  /// not necessarily valid UTF-8. No frames at all is possible (`Frames: 0`).
  Clip clip;

  /// In the order of their places. Each kind of oddity is told once, however often it occurs.
  std::vector<Warning> warnings;

  bool has_motion = true;                       ///< False: the file ends before MOTION.
  std::optional<std::int64_t> declared_frames;  ///< What `Frames:` says.
  std::optional<double> declared_frame_time;    ///< What `Frame Time:` says, in seconds.
  std::vector<std::string> roots;               ///< The roots of all trees in the file.
  int dropped_rows = 0;                         ///< Lines left out of a damaged file (lenient).
};

/// Reads BVH text.
///
/// A token stream over bytes: line ends (LF, CR LF, CR, mixed), indentation, letter case of
/// keywords and the wrapping of motion rows do not matter; a UTF-8 byte order mark is skipped;
/// `#` and `//` lines are skipped with a warning. Channel orders are per joint; rotations compose
/// left to right (intrinsic); a position replaces the offset component by component, except that
/// a joint below the root whose positions are 0 in all frames keeps a non-zero offset (with a
/// warning). The frame time means the rate 1/N when it is within 1e-4 of it, relatively.
///
/// Numbers are correctly rounded and independent of the locale. Every error has its line and
/// column (in bytes). More rows than declared are all read, with a warning; fewer are an error.
/// Rows may wrap or share lines as long as nothing hints that values were lost or added: a line
/// of a wrong length among rows of one line each is an error rather than a shift of columns.
/// Memory is bounded by the size of the text, not by what the header claims or by joints without
/// channels (BvhReadOptions::max_clip_bytes).
///
/// @param bytes      the whole file.
/// @param file_name  as the user named it, for messages.
/// @return ErrorKind::kInput errors; kUsage for a source_fps that is no rate.
[[nodiscard]] Result<BvhFile> read_bvh(std::string_view bytes, const std::string& file_name,
                                       const BvhReadOptions& options = {});

/// read_bvh of a file; `-` is standard input.
[[nodiscard]] Result<BvhFile> load_bvh(const std::string& path, const BvhReadOptions& options = {});

}  // namespace retarget
