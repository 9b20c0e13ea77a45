#pragma once

#include <optional>
#include <vector>

namespace retarget {

/// The rate of keys that are evenly spaced: frames per second at which each key falls on a frame.
///
/// Keys that an exporter left out, where nothing changes, do not matter; keys set by hand every
/// half second are no frames (rates below 12 or above 1000 per second are none).
/// @param times  seconds, in any order, several times each or not.
[[nodiscard]] std::optional<double> rate_of_keys(std::vector<double> times);

}  // namespace retarget
