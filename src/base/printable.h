#pragma once

#include <string>
#include <string_view>

namespace retarget {

/// The text with `?` for every character that commands a terminal or turns the direction of what it
/// shows: control characters but for tab and line feed, in ASCII, as bytes and in Unicode (U+0080 to
/// U+009F), marks of direction, separators of lines. Names in files may hold any of them.
[[nodiscard]] std::string printable(std::string_view text);

/// JSON text with such characters as `\u....`: the same content. @pre well-formed UTF-8
[[nodiscard]] std::string printable_json(std::string_view json);

}  // namespace retarget
