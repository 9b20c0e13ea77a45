#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "retarget/report.h"

namespace retarget {

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

/// `+` for a kept gate, `x` for a missed one, `-` for one without a value, a blank for metrics
/// without a gate.
[[nodiscard]] ReportPiece gate_mark(const GateResult* gate);

/// Text such as `<=40`, `>=1`, `-0.3..0.3`.
[[nodiscard]] std::string gate_bound_text(const GateResult& gate);

/// Text such as `walk.csv: 22 of 23 gates kept, 1 missed`.
[[nodiscard]] ReportLine verdict_of(const QualityReport& report);

/// Text such as `walk.csv: jumps is 2, expected at most 0`.
[[nodiscard]] std::string missed_text_of(const QualityReport& report, const GateResult& gate);

/// Where and when a gate was missed, worst first, at most three.
[[nodiscard]] std::vector<std::string> places_of_gate(const QualityReport& report,
                                                      const GateResult& gate);

}  // namespace retarget
