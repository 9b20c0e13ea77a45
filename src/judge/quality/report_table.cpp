#include "judge/quality/report_table.h"

#include <algorithm>
#include <string>
#include <utility>

#include "judge/quality/metric_group.h"

namespace retarget {
namespace {

using Table = std::vector<std::vector<ReportPiece>>;

// The mark of a gate takes two columns, even without a gate.
std::vector<ReportPiece> cells_of(const QualityReport& report, const Metric& metric, bool units) {
  const GateResult* gate = gate_on(report, metric.key);
  const MetricValue* found = report.find(metric.key);
  if (found == nullptr) return {{"-"}, gate_mark(gate)};
  std::string text = gate == nullptr ? figure_text(found->value) : figure_text(found->value, *gate);
  if (units && found->p95) text += " (" + figure_text(*found->p95) + ")";
  return {{text}, gate_mark(gate)};
}

std::string bound_of(std::span<const QualityReport> reports, const Metric& metric) {
  for (const QualityReport& report : reports) {
    if (const GateResult* gate = gate_on(report, metric.key)) return gate_bound_text(*gate);
  }
  return {};
}

// Pads columns to a common width; the first three are left-aligned.
std::vector<ReportLine> aligned(const Table& table) {
  constexpr std::size_t kFlushLeft = 3;
  std::vector<std::size_t> widths;
  for (const auto& row : table) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], row[i].text.size());
    }
  }
  std::vector<ReportLine> lines;
  for (const auto& row : table) {
    ReportLine line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - row[i].text.size(), ' ');
      const bool is_mark = i >= kFlushLeft && (i - kFlushLeft) % 2 == 1;
      if (i > 0) line.push_back({is_mark ? " " : "  "});
      if (i < kFlushLeft) {
        line.push_back(row[i]);
        line.push_back({padding});
      } else {
        line.push_back({padding});
        line.push_back(row[i]);
      }
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace

std::vector<const Metric*> metrics_by_group(std::span<const QualityReport> reports) {
  std::vector<const Metric*> metrics;
  for (const MetricGroup group : kMetricGroups) {
    for (const Metric& metric : quality_metrics()) {
      const bool is_in = std::ranges::any_of(reports, [&metric](const QualityReport& report) {
        return report.find(metric.key) != nullptr;
      });
      if (is_in && group_of(metric) == group) metrics.push_back(&metric);
    }
  }
  return metrics;
}

std::vector<ReportLine> metric_table(std::span<const QualityReport> reports,
                                     std::span<const Metric* const> metrics, bool units) {
  Table table = {{{""}, {"metric"}, {units ? "unit" : "gate"}}};
  for (const QualityReport& report : reports) {
    table[0].push_back({report.file});
    table[0].push_back({""});
  }
  std::string_view last;
  for (const Metric* metric : metrics) {
    const std::string_view group = group_name(group_of(*metric));
    std::vector<ReportPiece> row = {
        {group == last ? std::string() : std::string(group), ReportTone::kFaint},
        {std::string(metric->key)},
        {units ? std::string(metric->unit) : bound_of(reports, *metric)}};
    last = group;
    for (const QualityReport& report : reports) {
      for (ReportPiece& piece : cells_of(report, *metric, units)) row.push_back(std::move(piece));
    }
    table.push_back(std::move(row));
  }
  return aligned(table);
}

}  // namespace retarget
