#pragma once

#include <numbers>
#include <optional>
#include <string_view>

#include "retarget/measure.h"
#include "retarget/motion.h"
#include "retarget/report.h"

namespace retarget {

inline constexpr double kInCm = 100.0;  ///< Centimetres per metre.
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// A report under construction. Each group of metrics adds its values under their keys.
struct ReportBuilder {
  const RobotClip& clip;
  const QualityOptions& options;
  QualityReport& report;

  void set(std::string_view key, double value, std::optional<double> p95 = std::nullopt) const {
    report.values.push_back({find_metric(key), value, p95});
  }
};

/// A fraction in percent; 0 if the whole is 0.
[[nodiscard]] inline double percent(double part, double whole) {
  return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

}  // namespace retarget
