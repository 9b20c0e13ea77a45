#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace retarget {

/// Bytes as text of `A-Za-z0-9+/`, padded with `=` (RFC 4648).
[[nodiscard]] std::string base64_text(std::string_view bytes);

/// The bytes that such a text stands for, with or without padding; nothing for another text.
[[nodiscard]] std::optional<std::string> bytes_from_base64(std::string_view text);

}  // namespace retarget
