#pragma once

#include <array>

#include "retarget/enum_names.h"
#include "retarget/export.h"
#include "retarget/live.h"
#include "retarget/option_table.h"
#include "retarget/serve.h"

namespace RETARGET_API retarget {

inline constexpr const char* kLiveGroup = "Stream";

template <>
inline constexpr auto kEnumNames<LiveMode> =
    std::to_array<NamedValue<LiveMode>>({{LiveMode::kFrame, "frame"}, {LiveMode::kLag, "lag"}});
template <>
inline constexpr auto kEnumNames<LiveClock> = std::to_array<NamedValue<LiveClock>>(
    {{LiveClock::kSender, "sender"}, {LiveClock::kArrival, "arrival"}});

template <>
inline constexpr auto kEnumNames<LiveCalibration> =
    std::to_array<NamedValue<LiveCalibration>>({{LiveCalibration::kAuto, "auto"},
                                                {LiveCalibration::kTpose, "tpose"},
                                                {LiveCalibration::kNpose, "npose"}});
template <>
inline constexpr auto kEnumNames<LivePace> = std::to_array<NamedValue<LivePace>>(
    {{LivePace::kAuto, "auto"}, {LivePace::kClock, "clock"}, {LivePace::kInput, "input"}});

/// The option rows of LiveOptions.
[[nodiscard]] OptionTable live_table(LiveOptions& options);

}  // namespace retarget
