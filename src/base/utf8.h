#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace retarget {

/// Bytes of the well-formed UTF-8 character that begins at `at` (RFC 3629: neither longer than need
/// be, nor half of a surrogate pair); 0 where none does, as at the end of the text.
[[nodiscard]] std::size_t utf8_length(std::string_view text, std::size_t at);

/// The text with U+FFFD in place of every byte that is part of no well-formed UTF-8 character.
[[nodiscard]] std::string valid_utf8(std::string_view bytes);

/// Two digits a byte: `ff0a`.
[[nodiscard]] std::string hex_text(std::string_view bytes);

/// The bytes of hex_text; nothing for what is no such text.
[[nodiscard]] std::optional<std::string> bytes_from_hex(std::string_view hex);

}  // namespace retarget
