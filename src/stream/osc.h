#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A message of Open Sound Control 1.0 (opensoundcontrol.stanford.edu/spec-1_0.html), as far as
/// motion needs it: its texts and its numbers, each in their order; other arguments are passed over.
struct OscMessage {
  std::string_view address;
  std::vector<std::string_view> texts;
  std::vector<double> numbers;
};

/// The messages of a packet, those of bundles in their order; they refer to the packet. Errors
/// (kInput): what is no such packet.
[[nodiscard]] Result<std::vector<OscMessage>> read_osc(std::string_view packet);

}  // namespace retarget
