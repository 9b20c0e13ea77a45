#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {

/// A figure that a motion is judged by.
struct Metric {
  std::string_view key;         ///< Its name in JSON, gates and tables.
  std::string_view unit;        ///< `%` (of frames unless the definition says else), `rad/s`, ...
  std::string_view definition;  ///< For people, one or two sentences.
  std::string_view source;      ///< Where the definition comes from.
};

/// All metrics, in the order in which reports list them.
[[nodiscard]] std::span<const Metric> quality_metrics();

/// By key; nullptr for an unknown one.
[[nodiscard]] const Metric* find_metric(std::string_view key);

/// All keys, for messages.
[[nodiscard]] std::vector<std::string> metric_keys();

}  // namespace retarget
