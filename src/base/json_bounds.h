#pragma once

#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Whether a JSON text is none that takes long or much to parse: lists or objects nested more than
/// 100 deep, objects of more than 2,000 members, more than 200,000 members in all, and texts of more
/// than 16 MiB are kConfig errors with line and column. Of no use for texts that are no JSON.
[[nodiscard]] Result<void> check_json_bounds(std::string_view text, const std::string& file);

}  // namespace retarget
