#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace retarget {

/// Encodes bytes as Base64, alphabet `A-Za-z0-9+/`, padded with `=` (RFC 4648).
[[nodiscard]] std::string base64_text(std::string_view bytes);

/// Decodes Base64 text, with or without padding. Returns nothing for invalid text.
[[nodiscard]] std::optional<std::string> bytes_from_base64(std::string_view text);

}  // namespace retarget
