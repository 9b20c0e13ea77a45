#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "retarget/enum_names.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/live.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
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

/// Leaves inverse kinematics only: no speed limits, no floor and foot corrections.
void make_plain(LiveOptions& options);

/// A table whose options add their names to `given` when they are set, so that options without an
/// effect can be reported. Both must outlive the table.
[[nodiscard]] OptionTable noting_given(OptionTable table, std::vector<std::string>& given);

/// Rejects options of a session that have no effect with the others (kUsage): `lag` without kLag;
/// options of the fit that single frames do not use.
/// @param given  names of the options that were set.
[[nodiscard]] Result<void> check_live_use(const LiveOptions& options, const Options& run,
                                          std::span<const std::string> given);

/// Checks options of a session that solves with a method. Errors (kUsage): values out of range;
/// kLag with the method `gmr`.
[[nodiscard]] Result<void> check_live_options(const LiveOptions& options, Method method);

}  // namespace retarget
