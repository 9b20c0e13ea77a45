#pragma once

#include <algorithm>
#include <string_view>

#include "human/skeleton/calibrate.h"

namespace retarget {

/// Whether a message in Calibration::doubts contains a text.
inline bool has_doubt(const Calibration& calibration, std::string_view text) {
  return std::ranges::any_of(calibration.doubts, [&](const Warning& doubt) {
    return doubt.message.find(text) != std::string::npos;
  });
}

}  // namespace retarget
