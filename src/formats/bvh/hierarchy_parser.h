#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "formats/bvh/source_text.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// The HIERARCHY section of a file: all trees in sequence.
struct Hierarchy {
  std::vector<Joint> joints;        ///< Joints of all trees; the parent of a root is -1.
  std::vector<std::size_t> places;  ///< Byte offset of each joint's name.
  std::vector<int> roots;           ///< Indices of the roots.
  bool has_motion = false;          ///< Ends with MOTION, not with the text.
  std::vector<Warning> warnings;
};

/// Parses from HIERARCHY up to and including MOTION, or to the end of the text.
///
/// Keywords are case-insensitive. A name extends to the end of its line or to a `{`. OFFSET and
/// CHANNELS may come in either order. The parser is not recursive, so the nesting depth is
/// unlimited.
///
/// @param root  the root of the wanted tree; when empty, a second ROOT is an error that names both.
[[nodiscard]] Result<Hierarchy> parse_hierarchy(const SourceText& source, Scanner& scanner,
                                                std::string_view root);

}  // namespace retarget
