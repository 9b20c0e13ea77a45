#pragma once

#include <string>

#include "retarget/options.h"

namespace retarget {

/// What a clip of a batch is of its file: all of it, a part, the mirror image of either.
struct ClipVariant {
  /// BatchInput::relative of the whole file; empty: the clip is the file.
  std::string source = {};
  /// `1.5:3` in seconds or `f45:f90` in frames; empty: all of the file.
  std::string part = {};
  /// BatchInput::relative of the clip whose mirror image it is; empty: it is none.
  std::string mirror_of = {};

  [[nodiscard]] bool is_mirrored() const { return !mirror_of.empty(); }
  friend bool operator==(const ClipVariant&, const ClipVariant&) = default;
};

/// Both ends of a part as text, each seconds or `f` and a frame, or empty.
[[nodiscard]] std::string part_text(const std::string& start, const std::string& end);

/// What a part means as options; frames up to, not including, the end, seconds including it.
/// @pre the text is part_text() of sound ends
[[nodiscard]] PartOptions part_options(const std::string& part);

/// The path of a clip's mirror image: `a/walk.bvh` becomes `a/walk_mirrored.bvh`.
[[nodiscard]] std::string mirrored_name(const std::string& relative);

}  // namespace retarget
