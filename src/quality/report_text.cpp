#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/number_text.h"
#include "retarget/report.h"

namespace retarget {
namespace {

// four significant digits where there are decimals
std::string text_of(double value) {
  const double size = std::abs(value);
  const int decimals = size >= 1000.0 ? 0 : size >= 100.0 ? 1 : size >= 1.0 ? 2 : 4;
  return number_text(value, decimals);
}

std::string cell_of(const QualityReport& report, const Metric& metric) {
  const MetricValue* found = report.find(metric.key);
  if (found == nullptr) return "-";
  std::string text = text_of(found->value);
  if (found->p95) text += " (" + text_of(*found->p95) + ")";
  const auto gate = std::ranges::find(report.gates, metric.key, &GateResult::metric);
  if (gate != report.gates.end() && !gate->passed) text += " *";
  return text;
}

using Table = std::vector<std::vector<std::string>>;

// columns padded to one width each, the first flush left
std::string aligned(const Table& table) {
  std::vector<std::size_t> widths;
  for (const auto& row : table) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : table) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - row[i].size(), ' ');
      line += (i == 0 ? "" : "  ") + (i < 2 ? row[i] + padding : padding + row[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string bounds_of(const GateResult& gate) {
  if (gate.min && gate.max) return text_of(*gate.min) + " to " + text_of(*gate.max);
  return gate.max ? "at most " + text_of(*gate.max) : "at least " + text_of(*gate.min);
}

std::string frames_of(const Fault& fault) {
  if (fault.end == fault.begin + 1) return "frame " + std::to_string(fault.begin);
  return "frames " + std::to_string(fault.begin) + "-" + std::to_string(fault.end - 1) +
         ", worst " + std::to_string(fault.worst_frame);
}

// gates that were missed, each with the worst of its faults
std::string missed_text(const QualityReport& report) {
  constexpr int kShown = 3;
  std::string text;
  for (const GateResult& gate : report.gates) {
    if (gate.passed) continue;
    text += report.file + ": " + gate.metric + " is " + text_of(*gate.value) + ", wanted " +
            bounds_of(gate) + "\n";
    if (gate.metric == "trunk_lean_error_deg" && report.trunk_lean) {
      text += "  on average the robot leans by " + text_of(report.trunk_lean->robot) +
              " degrees, the human by " + text_of(report.trunk_lean->human) + "\n";
    }
    int shown = 0;
    for (const Fault& fault : report.faults) {
      // both measures of self-collision list the faults of every frame
      const bool of_gate = fault.metric == gate.metric ||
                           (gate.metric == "self_1cm_pct" && fault.metric == "self_all_1cm_pct");
      if (!of_gate || shown == kShown) continue;
      ++shown;
      text += "  " + fault.where + ": " + text_of(fault.amount) + " " + fault.unit + ", " +
              frames_of(fault) + "\n";
    }
  }
  return text;
}

// gates that are off, with the reason
std::string skipped_text(const QualityReport& report) {
  std::string names, reason;
  for (const GateResult& gate : report.gates) {
    if (gate.not_applicable.empty()) continue;
    names += (names.empty() ? "" : ", ") + gate.metric;
    if (reason.empty()) reason = gate.not_applicable;
  }
  return names.empty() ? names : report.file + ": " + reason + ": " + names + "\n";
}

}  // namespace

std::string report_text(std::span<const QualityReport> reports) {
  Table table = {{"metric", "unit"}};
  for (const QualityReport& report : reports) table[0].push_back(report.file);
  std::vector<std::string> frames = {"frames", ""}, limits = {"limits", ""};
  for (const QualityReport& report : reports) {
    frames.push_back(std::to_string(report.frames));
    limits.push_back(report.limits);
  }
  table.push_back(frames);
  table.push_back(limits);
  for (const Metric& metric : quality_metrics()) {
    const bool measured = std::ranges::any_of(reports, [&metric](const QualityReport& report) {
      return report.find(metric.key) != nullptr;
    });
    if (!measured) continue;
    std::vector<std::string> row = {std::string(metric.key), std::string(metric.unit)};
    for (const QualityReport& report : reports) row.push_back(cell_of(report, metric));
    table.push_back(std::move(row));
  }
  std::string text = aligned(table);
  std::string missed;
  for (const QualityReport& report : reports) missed += missed_text(report);
  if (!missed.empty()) text += "\n* gates missed:\n" + missed;
  std::string skipped;
  for (const QualityReport& report : reports) skipped += skipped_text(report);
  if (!skipped.empty()) text += "\ngates not applicable:\n" + skipped;
  return text;
}

}  // namespace retarget
