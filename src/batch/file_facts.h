#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace retarget {

/// File attributes that are known without reading the content.
struct FileFacts {
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< Last modification, nanoseconds since 1970.
};

/// Attributes of a file. For a folder that is a motion (SONIC), the total size and the latest
/// modification of its files. Returns nothing for anything else.
[[nodiscard]] std::optional<FileFacts> facts_of(const std::string& path);

}  // namespace retarget
