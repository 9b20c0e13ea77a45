#pragma once

#include <array>

#include "options/enum_names.h"
#include "options/option_table.h"
#include "retarget/live.h"

namespace retarget {

inline constexpr const char* kLiveGroup = "Stream";

template <>
inline constexpr auto kEnumNames<LiveMode> =
    std::to_array<NamedValue<LiveMode>>({{LiveMode::kFrame, "frame"}, {LiveMode::kLag, "lag"}});
template <>
inline constexpr auto kEnumNames<LiveClock> = std::to_array<NamedValue<LiveClock>>(
    {{LiveClock::kSender, "sender"}, {LiveClock::kArrival, "arrival"}});

/// The rows of LiveOptions.
[[nodiscard]] OptionTable live_table(LiveOptions& options);

}  // namespace retarget
