#pragma once

#include <string>

#include "retarget/options.h"

namespace retarget {

/// The content of a clip relative to its file: the whole file, a part, or the mirror image of
/// either.
struct ClipVariant {
  /// BatchInput::relative of the whole file; empty: the clip is the whole file.
  std::string source = {};
  /// `1.5:3` in seconds or `f45:f90` in frames; empty: the whole file.
  std::string part = {};
  /// BatchInput::relative of the clip that is mirrored; empty: not mirrored.
  std::string mirror_of = {};

  [[nodiscard]] bool is_mirrored() const { return !mirror_of.empty(); }
  friend bool operator==(const ClipVariant&, const ClipVariant&) = default;
};

/// Formats both ends of a part; each is seconds, `f` and a frame, or empty.
[[nodiscard]] std::string part_text(const std::string& start, const std::string& end);

/// Converts a part to options. Frames exclude the end, seconds include it.
/// @pre the text is part_text() of valid ends
[[nodiscard]] PartOptions part_options(const std::string& part);

/// The path of a clip's mirror image: `a/walk.bvh` becomes `a/walk_mirrored.bvh`.
[[nodiscard]] std::string mirrored_name(const std::string& relative);

}  // namespace retarget
