#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "bvh/source_text.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// The HIERARCHY part of a file as it is written: all trees, one after the other.
struct Hierarchy {
  std::vector<Joint> joints;        ///< Of all trees; a root's parent is -1.
  std::vector<std::size_t> places;  ///< Byte offset of each joint's name.
  std::vector<int> roots;           ///< Indices of the roots.
  bool has_motion = false;          ///< The keyword MOTION ends it (not the end of the file).
  std::vector<Warning> warnings;
};

/// Reads from HIERARCHY up to and including MOTION, or to the end of the text.
///
/// Keywords in any case; a name goes to the end of its line or to a `{`; OFFSET and CHANNELS in
/// either order. Works without recursion, so nesting has no limit.
///
/// @param root  the tree that is wanted; when empty, a second ROOT is an error that names both.
[[nodiscard]] Result<Hierarchy> parse_hierarchy(const SourceText& source, Scanner& scanner,
                                                std::string_view root);

}  // namespace retarget
