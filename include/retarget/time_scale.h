#pragma once

#include <string>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Least factor of a time scale: a motion never becomes slower than a quarter of its speed.
inline constexpr double kLeastTimeScale = 0.25;

/// A part of a motion that is slowed down.
struct SlowedStretch {
  double begin = 0.0, end = 0.0;  ///< Source time, seconds since the start of the used part.
  double factor = 1.0;            ///< Least speed in it, relative to the source.
  std::string cause;              ///< `left_knee_joint speed`, ...; empty: the factor was given.
};

/// How the time of a source is scaled (docs/references.md). The pace, seconds of the motion per
/// second of the source, is a cubic spline with continuous second derivative and at least 1, so the
/// time of the motion increases with that of the source and has a continuous third derivative.
struct TimeScale {
  double knot_time = 0.1;  ///< Source time between two knots, seconds.
  /// B-spline coefficients: the piece from knot i to i + 1 depends on i to i + 3. Missing ones at
  /// the end are 1.
  std::vector<double> pace;
  std::vector<SlowedStretch> stretches;  ///< Where the pace is above 1.
  /// Places at which the motion remains beyond a limit, because slowing does not help.
  std::vector<SlowedStretch> left;
  double longer = 0.0;  ///< Added time, seconds.

  [[nodiscard]] double least_factor() const;
};

}  // namespace retarget
