#pragma once

#include <string>
#include <string_view>

namespace retarget {

/// Bytes as text of `A-Za-z0-9+/`, padded with `=` (RFC 4648).
[[nodiscard]] std::string base64_text(std::string_view bytes);

}  // namespace retarget
