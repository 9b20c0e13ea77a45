#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

struct BvhReadOptions {
  /// Keep the complete rows of a damaged file (truncated, malformed numbers, NaN, rows of wrong
  /// length) and report dropped rows in a warning. A file without any complete row, and errors
  /// before the rows, remain errors.
  bool lenient = false;

  /// Accept a file that ends before MOTION as a skeleton without frames. A MOTION section that is
  /// present is checked as usual.
  bool motion_optional = false;

  /// Frame rate in Hz that replaces the header's frame time, which may then be missing or 0.
  std::optional<double> source_fps;

  /// Memory limit of the clip in bytes; a larger clip is an error. Since a skeleton can be much
  /// larger than its rows, a clip may also never exceed kMaxBytesOfText times the size of the text,
  /// or kFreeClipBytes if that is more.
  std::size_t max_clip_bytes = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t kMaxBytesOfText = 64;
  static constexpr std::size_t kFreeClipBytes = std::size_t{32} << 20;

  /// Root of the tree to read when a file holds several; may be empty when there is only one.
  std::string root;
};

/// The motion of a BVH file.
struct BvhFile {
  /// Lengths and axes as in the file. Joint names are the file's bytes: without control bytes, but
  /// not necessarily valid UTF-8. May have no frames (`Frames: 0`).
  Clip clip;

  /// Warnings in file order. Each kind is reported once, however often it occurs.
  std::vector<Warning> warnings;
};

/// Parses BVH text.
///
/// The parser reads a token stream over bytes. Line ends (LF, CR LF, CR, mixed), indentation,
/// letter case of keywords and the wrapping of motion rows do not matter. A UTF-8 byte order mark
/// is skipped; `#` and `//` lines are skipped with a warning. The channel order is per joint.
/// Rotations compose left to right (intrinsic). A position replaces the offset component by
/// component, unless the positions of a joint below the root are relative to the offset, as zeros
/// are (with a warning; see read_positions_beside_offsets). A frame time within a relative 1e-4 of
/// 1/N means the rate N.
///
/// Numbers are correctly rounded and independent of the locale. Every error has its line and column
/// (in bytes). More rows than declared are all read, with a warning; fewer are an error. Rows may
/// wrap or share lines as long as no line suggests lost or extra values: if rows otherwise take one
/// line each, a line of a wrong length is an error, because it would shift columns. Memory is
/// bounded by the size of the text, not by the header's claims or by joints without channels
/// (BvhReadOptions::max_clip_bytes).
///
/// @param bytes      the whole file.
/// @param file_name  name given by the user, for messages.
/// @return ErrorKind::kInput errors; kUsage for an invalid source_fps.
[[nodiscard]] Result<BvhFile> read_bvh(std::string_view bytes, const std::string& file_name,
                                       const BvhReadOptions& options = {});

/// Reads and parses a BVH file; `-` is standard input.
[[nodiscard]] Result<BvhFile> load_bvh(const std::string& path, const BvhReadOptions& options = {});

/// Joints whose position channels do not hold positions.
struct PositionReading {
  std::vector<int> unmoved;  ///< 0 in every frame: the joint stays at its OFFSET.
  std::vector<int> changes;  ///< Small relative to the OFFSET in every frame: they are added to the
                             ///< OFFSET.
};

/// Corrects position channels that are relative to the OFFSET.
///
/// A position channel normally replaces its component of the OFFSET. Some exporters instead write
/// zeros for joints that stay at their offset (MakeHuman), rounding noise, or displacements from
/// the OFFSET. A joint below the root is treated as relative when its positions stay below a
/// twentieth of its OFFSET in all frames. If more than half of the joints are relative, so is each
/// other joint whose positions are on average nearer to 0 than to its OFFSET. The OFFSET is added
/// to the positions of relative joints.
PositionReading read_positions_beside_offsets(Clip& clip);

/// Whether the reader would treat a joint's positions as relative to its OFFSET: the joint is below
/// the root and its positions stay near 0 compared with the OFFSET.
[[nodiscard]] bool has_positions_near_zero(const Clip& clip, int joint);

}  // namespace retarget
