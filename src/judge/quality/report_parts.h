#pragma once

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

/// Groups faults into runs of consecutive frames, separately for each joint or body.
class FaultList {
 public:
  FaultList(std::string_view metric, std::string_view unit) : metric_(metric), unit_(unit) {}

  /// @pre frames of the same `where` are added in increasing order
  void add(const std::string& where, int frame, double amount);
  /// Appends the `max` worst runs, worst first, earliest first among equals, and the total number
  /// of runs.
  void move_to(QualityReport& report, std::size_t max);

 private:
  std::string metric_, unit_;
  std::vector<Fault> runs_;
  std::map<std::string, std::size_t> last_run_;  // By `where`.
};

/// Parts of human-readable reports.

enum class ReportTone : unsigned char { kPlain, kGood, kBad, kFaint };

/// Text in one colour.
struct ReportPiece {
  std::string text;
  ReportTone tone = ReportTone::kPlain;
};
using ReportLine = std::vector<ReportPiece>;

/// Renders the lines with printable names and, if wanted, in colour.
[[nodiscard]] std::string rendered(const std::vector<ReportLine>& lines, bool colour);

/// Formats a value with four significant digits, or with more if needed to show that it misses a
/// bound.
[[nodiscard]] std::string figure_text(double value);
[[nodiscard]] std::string figure_text(double value, const GateResult& gate);

/// The gate on a metric; nullptr if it has none.
[[nodiscard]] const GateResult* gate_on(const QualityReport& report, std::string_view key);

/// `+` for a passed gate, `x` for a missed one, `-` for one without a value, a blank for metrics
/// without a gate.
[[nodiscard]] ReportPiece gate_mark(const GateResult* gate);

/// Text such as `<=40`, `>=1`, `-0.3..0.3`.
[[nodiscard]] std::string gate_bound_text(const GateResult& gate);

/// Text such as `walk.csv: 22 of 23 gates passed, 1 missed`.
[[nodiscard]] ReportLine verdict_of(const QualityReport& report);

/// Text such as `walk.csv: jumps is 2, expected at most 0`.
[[nodiscard]] std::string missed_text_of(const QualityReport& report, const GateResult& gate);

/// Locations and frames of a missed gate, worst first, at most three.
[[nodiscard]] std::vector<std::string> places_of_gate(const QualityReport& report,
                                                      const GateResult& gate);

}  // namespace retarget
