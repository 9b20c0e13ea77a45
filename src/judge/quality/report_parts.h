#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/measure.h"
#include "retarget/motion.h"
#include "retarget/report.h"

namespace retarget {

inline constexpr double kInCm = 100.0;  ///< Centimetres per metre.
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// A report under construction. The measure_...() functions add their values to it.
struct ReportBuilder {
  const RobotClip& clip;
  const QualityOptions& options;
  QualityReport& report;

  /// Adds the value of a metric. @pre the key is that of a metric.
  void set(std::string_view key, double value, std::optional<double> p95 = std::nullopt) const {
    report.values.push_back({find_metric(key), value, p95});
  }
};

/// A fraction in percent; 0 if the whole is 0.
[[nodiscard]] inline double percent(double part, double whole) {
  return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

/// Number of frames between the positions whose differences are a slip or a jerk: 1, and at more
/// than 180 frames per second about 1/120 s. Positions in files have six decimals. Their rounding adds 2 m/s^3 to the
/// jerk of consecutive frames at 120 frames per second, and 2,000 m/s^3 at 1,000.
[[nodiscard]] inline int difference_stride(double fps) {
  constexpr double kHighestRate = 120.0;
  return std::max(1, static_cast<int>(std::lround(fps / kHighestRate)));
}

/// Groups the faults of a metric into runs of consecutive frames, separately for each joint or
/// body.
class FaultList {
 public:
  FaultList(std::string_view metric, std::string_view unit) : metric_(metric), unit_(unit) {}

  /// Adds a bad frame of a joint or body. NaN becomes infinity.
  /// @pre frames of the same `where` are added in increasing order.
  void add(const std::string& where, int frame, double amount);
  /// Appends the `max` worst runs and the total number of runs to the report. The worst run is
  /// first; among equals, the earliest.
  void move_to(QualityReport& report, std::size_t max);

 private:
  std::string metric_, unit_;
  std::vector<Fault> runs_;
  std::map<std::string, std::size_t> last_run_;  // By `where`.
};

/// Colour of a text in a human-readable report.
enum class ReportTone : unsigned char { kPlain, kGood, kBad, kFaint };

/// Text in one colour.
struct ReportPiece {
  std::string text;
  ReportTone tone = ReportTone::kPlain;
};
using ReportLine = std::vector<ReportPiece>;

/// Joins the lines to a text with printable names.
/// @param colour  whether to add ANSI colour codes.
[[nodiscard]] std::string rendered(const std::vector<ReportLine>& lines, bool colour);

/// Formats a value with two decimals, or fewer for large and more for small values. A value that
/// misses a gate gets as many decimals as needed to differ from the bound.
[[nodiscard]] std::string figure_text(double value);
[[nodiscard]] std::string figure_text(double value, const GateResult& gate);

/// The gate on a metric; nullptr if it has none.
[[nodiscard]] const GateResult* gate_on(const QualityReport& report, std::string_view key);

/// `+` for a passed gate, `x` for a missed gate, `-` for a gate without a value, a blank without a
/// gate.
[[nodiscard]] ReportPiece gate_mark(const GateResult* gate);

/// Text such as `<=40`, `>=1`, `-0.3..0.3`.
[[nodiscard]] std::string gate_bound_text(const GateResult& gate);

/// Text such as `walk.csv: 22 of 23 gates passed, 1 missed`.
[[nodiscard]] ReportLine verdict_of(const QualityReport& report);

/// Text such as `walk.csv: jumps is 2, expected at most 0`.
[[nodiscard]] std::string missed_text_of(const QualityReport& report, const GateResult& gate);

/// Locations and frames at which a gate is missed, worst first, at most three.
[[nodiscard]] std::vector<std::string> places_of_gate(const QualityReport& report,
                                                      const GateResult& gate);

}  // namespace retarget
