#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace retarget {

/// Length in bytes of the well-formed UTF-8 character at `at` (RFC 3629: no overlong forms, no
/// surrogates). Returns 0 for invalid UTF-8 and at the end of the text.
[[nodiscard]] std::size_t utf8_length(std::string_view text, std::size_t at);

/// Replaces each byte that is not part of a well-formed UTF-8 character by U+FFFD.
[[nodiscard]] std::string valid_utf8(std::string_view bytes);

/// Two hexadecimal digits per byte: `ff0a`.
[[nodiscard]] std::string hex_text(std::string_view bytes);

/// Decodes hex_text. Returns nothing for any other text.
[[nodiscard]] std::optional<std::string> bytes_from_hex(std::string_view hex);

}  // namespace retarget
