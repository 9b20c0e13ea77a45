#pragma once

#include <algorithm>

namespace retarget {

/// The quintic from 0 to 1 with zero velocity and acceleration at both ends; constant beyond them.
[[nodiscard]] inline double quintic_step(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

}  // namespace retarget
