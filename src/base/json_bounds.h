#pragma once

#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Refuses JSON text that takes too much time or memory to parse: lists or objects nested more than
/// 100 deep, objects with more than 2,000 members, more than 200,000 members in total, and more
/// than 16 MiB of text. These are kConfig errors with line and column. The check does not detect
/// malformed JSON.
[[nodiscard]] Result<void> check_json_bounds(std::string_view text, const std::string& file);

}  // namespace retarget
