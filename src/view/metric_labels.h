#pragma once

#include <string_view>

namespace retarget {

/// Plain name of a metric of quality_metrics(), as pages show it instead of its key; the key if it is
/// unknown.
[[nodiscard]] std::string_view metric_label(std::string_view key);

}  // namespace retarget
