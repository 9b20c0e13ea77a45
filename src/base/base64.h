#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace retarget {

/// Bytes as text of `A-Za-z0-9+/`, padded with `=` (RFC 4648).
[[nodiscard]] std::string base64_text(std::string_view bytes);

/// The bytes of such a text; nothing: it is none.
[[nodiscard]] std::optional<std::string> base64_bytes(std::string_view text);

}  // namespace retarget
