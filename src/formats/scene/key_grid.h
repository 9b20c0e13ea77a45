#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Rates of keys that count as frames, Hz: keys that are set by hand every half second are not
/// frames.
inline constexpr double kMinKeyRate = 12.0, kMaxKeyRate = 1000.0;

/// Keys as frames of a motion.
struct KeyGrid {
  double fps = 0.0;                  ///< Mean over all keys; any positive number.
  FrameRate rate;                    ///< The exact rate that the keys mean.
  std::vector<double> times;         ///< Seconds, ascending, at most one per frame.
  std::vector<std::int64_t> frames;  ///< Frame of each time; the first is 0.

  /// Time of a frame in seconds: that of its key, otherwise between the nearest keys.
  [[nodiscard]] double time_of(std::int64_t frame) const;
};

/// Ascending times without times that equal the next one up to rounding.
[[nodiscard]] std::vector<double> distinct_times(std::vector<double> times);

/// Finds the frames of evenly spaced keys. Keys that an exporter omitted because nothing changes do
/// not matter, but at least two keys must be adjacent.
///
/// The times may be rounded: to single precision, or to milliseconds and finer decimal units. Among
/// the rates that explain the times within their rounding, a usual one is chosen.
/// @param times  seconds, in any order, with or without duplicates.
/// @return nothing if the keys are uneven or fewer than three.
[[nodiscard]] std::optional<KeyGrid> grid_of_keys(std::vector<double> times);

}  // namespace retarget
