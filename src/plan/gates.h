#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/report.h"

namespace retarget {

/// The gates of configs/quality/default.json.
[[nodiscard]] Result<Gates> default_gates(const std::string& data_folder);

}  // namespace retarget
