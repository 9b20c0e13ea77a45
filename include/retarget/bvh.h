#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

// Reading: load_clip and load_skeleton (load.h).

/// Options for writing a clip as BVH.
struct BvhWriteOptions {
  /// Decimals of offsets, positions and angles, 0 to 17. If empty, numbers have as many digits as
  /// an exact round trip needs. The frame time always does.
  std::optional<int> decimals;
};

/// Formats the clip as BVH text with LF line ends, in any locale.
///
/// Each joint's channels are written as its skeleton lists them, rotations in the joint's own order
/// in degrees. Of all angles that represent a rotation, those nearest to the previous frame are
/// written (in the first frame: nearest to 0), so that angles do not jump. Scale channels are 1.
/// Without `decimals`, reading the text gives the same rotations, translations and offsets to 1e-9;
/// a quaternion may change its sign.
///
/// @return ErrorKind::kRun errors, with joint and frame, for content that BVH cannot represent:
///     values that are not finite, a rotation that the joint's channels cannot represent (fewer
///     than three different axes), a translation that differs from the offset along an axis without
///     a position channel, names that are empty or hold line ends or `{`, frames without any
///     channel, joints that are not in depth-first order.
[[nodiscard]] Result<std::string> format_bvh(const Clip& clip, const BvhWriteOptions& options = {});

/// Writes the clip to a file, completely or not at all; `-` is standard output.
[[nodiscard]] Result<void> save_bvh(const std::string& path, const Clip& clip,
                                    const BvhWriteOptions& options = {});

/// Makes names valid for BVH: no control bytes, not empty, no spaces at the ends.
[[nodiscard]] std::vector<std::string> plain_joint_names(std::vector<std::string> names);

/// Reads the skeleton of BVH text that ends before its MOTION section or has one.
/// @param file  used in messages. Errors: those of load_clip for BVH files.
[[nodiscard]] Result<std::shared_ptr<const Skeleton>> bvh_skeleton(std::string_view text,
                                                                   const std::string& file);

/// Reads single rows of a BVH file's MOTION section, as streams send them.
class BvhRowReader {
 public:
  explicit BvhRowReader(const Skeleton& skeleton);
  ~BvhRowReader();
  BvhRowReader(BvhRowReader&&) noexcept;
  BvhRowReader& operator=(BvhRowReader&&) noexcept;

  /// Reads a row into a frame of a clip of this skeleton. Does not allocate.
  /// @param line  all channels of a frame, separated by blanks; positions in the file's unit,
  ///     rotations in degrees.
  /// kInput errors: not exactly one number per channel, or numbers of ten million and more; the
  ///     frame is then unchanged.
  [[nodiscard]] Result<void> read(std::string_view line, Clip& clip, int frame);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
