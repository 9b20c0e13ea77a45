#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace retarget {

/// What can be seen of a motion without reading it.
struct FileFacts {
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< Nanoseconds since 1970, of the last change.
};

/// Of a file; of a folder that is a motion (SONIC's) those of what is in it, all together and the
/// latest. Nothing: it is neither.
[[nodiscard]] std::optional<FileFacts> facts_of(const std::string& path);

}  // namespace retarget
