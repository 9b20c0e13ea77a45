#pragma once

#include <string>

#include "retarget/human.h"

namespace retarget {

/// The up axis of a calibration and the tilt that it corrects: `+y`, `+y levelled by 12.0 degrees`.
[[nodiscard]] std::string up_text(const Calibration& calibration);

/// One human-readable line about a calibration.
/// @param evidence  Rest::evidence
[[nodiscard]] std::string describe_calibration(const Calibration& calibration,
                                               const std::string& evidence);

}  // namespace retarget
