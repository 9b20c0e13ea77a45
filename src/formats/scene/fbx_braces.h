#pragma once

#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Checks that all nodes of a text FBX file are closed. ufbx also reads files that are cut off
/// inside their last section, which then lack the motion of some limbs.
/// @return kInput errors with the last line.
[[nodiscard]] Result<void> check_fbx_text(std::string_view text, const std::string& file_name);

}  // namespace retarget
