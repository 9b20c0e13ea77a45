#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Smallest factor of a time scale: a motion never becomes slower than a quarter of its speed.
inline constexpr double kLeastTimeScale = 0.25;

/// A part of a motion that is slowed down.
struct SlowedStretch {
  double begin = 0.0, end = 0.0;  ///< Source time, seconds since the start of the used part.
  double factor = 1.0;            ///< Smallest speed in it, relative to the source.
  std::string cause;              ///< `left_knee_joint speed`, ...; empty: the user's factor.
};

/// A time scale of a source (docs/references.md). The pace, seconds of the motion per second of the
/// source, is a cubic spline with a continuous second derivative and values of at least 1. The time
/// of the motion therefore increases with that of the source and has a continuous third derivative.
struct TimeScale {
  double knot_time = 0.1;  ///< Source time between two knots, seconds.
  /// B-spline coefficients: the segment from knot i to i + 1 depends on i to i + 3. Coefficients
  /// beyond the end are 1.
  std::vector<double> pace;
  std::vector<SlowedStretch> stretches;  ///< Parts with a pace above 1.
  /// Parts in which the motion remains beyond a limit, because a lower speed does not help.
  std::vector<SlowedStretch> left;
  double longer = 0.0;  ///< Added time, seconds.

  /// The smallest factor of all stretches; 1 without stretches.
  [[nodiscard]] double least_factor() const;
};

/// The pace if it is the same everywhere; otherwise, and without a time scale, 1.
[[nodiscard]] double constant_pace(const std::optional<TimeScale>& scale);

}  // namespace retarget
