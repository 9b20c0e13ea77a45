#pragma once

#include <optional>
#include <string_view>

#include "retarget/option_table.h"
#include "retarget/text.h"

namespace retarget {

/// Further uses of options of a run. To judge or show a motion, its source must be read and
/// interpreted as in the run that made it.
inline constexpr OptionUse kJudged = OptionUse::kMeasure | OptionUse::kShow | OptionUse::kShowBatch;
inline constexpr OptionUse kReading = kJudged | OptionUse::kInspect | OptionUse::kEdit;
inline constexpr OptionUse kHuman =
    kJudged | OptionUse::kInspect | OptionUse::kEdit | OptionUse::kLive;
inline constexpr OptionUse kRobot =
    OptionUse::kMeasure | OptionUse::kShow | OptionUse::kConvert | OptionUse::kLive;

/// Limits of frame rates: wide enough for any motion, narrow enough to catch typing errors.
inline constexpr double kMinRate = 0.001, kMaxRate = 1e6;

/// The number in a text; empty without a number in [min, max].
[[nodiscard]] inline std::optional<double> number_in(std::string_view text, double min,
                                                     double max) {
  const auto number = parse_number<double>(text);
  return number && *number >= min && *number <= max ? number : std::nullopt;
}

}  // namespace retarget
