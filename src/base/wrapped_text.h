#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace retarget {

/// Columns of a terminal that no line for people goes beyond, unless a single word does.
inline constexpr std::size_t kTextWidth = 80;

/// A text broken at blanks, so that no line is longer than `width`; characters are counted, not
/// bytes. Line ends of the text stay.
/// @param used    columns that stand before the text's first line already.
/// @param indent  blanks before each further line of a line that was broken.
[[nodiscard]] std::string wrapped_text(std::string_view text, std::size_t used, std::size_t indent,
                                       std::size_t width = kTextWidth);

}  // namespace retarget
