#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "judge/quality/metric_group.h"
#include "judge/quality/report_parts.h"
#include "retarget/measure.h"
#include "retarget/report.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr const char* kLegend = "+ passed, x missed, - not measured";

// Width of the group labels, and of the first of two columns of values.
constexpr std::size_t kLabelWidth = 12, kCellWidth = 34;

using Lines = std::vector<ReportLine>;

void append(Lines& lines, Lines more) {
  for (ReportLine& line : more) lines.push_back(std::move(line));
}

// A metric's mark, value and bound. @pre the report contains the metric.
ReportLine cell_of(const QualityReport& report, const Metric& metric) {
  const GateResult* gate = gate_on(report, metric.key);
  const double value = report.find(metric.key)->value;
  ReportPiece mark = gate_mark(gate);
  const std::string figure = gate == nullptr ? figure_text(value) : figure_text(value, *gate);
  const ReportTone tone = mark.tone == ReportTone::kBad ? ReportTone::kBad : ReportTone::kPlain;
  ReportLine cell = {std::move(mark), {" " + std::string(metric.key) + " "}, {figure, tone}};
  if (gate != nullptr) cell.push_back({" " + gate_bound_text(*gate), ReportTone::kFaint});
  return cell;
}

std::size_t width_of(const ReportLine& line) {
  std::size_t width = 0;
  for (const ReportPiece& piece : line) width += piece.text.size();
  return width;
}

// The values of one group, two per line if they fit.
Lines group_lines(std::string_view label, std::vector<ReportLine> cells) {
  Lines lines;
  for (ReportLine& cell : cells) {
    const bool fits = !lines.empty() && width_of(lines.back()) < kLabelWidth + kCellWidth &&
                      kLabelWidth + kCellWidth + width_of(cell) <= kTextWidth;
    if (!fits) {
      std::string start(lines.empty() ? label : "");
      start.resize(kLabelWidth, ' ');
      lines.push_back({{std::move(start), ReportTone::kFaint}});
    } else {
      const std::size_t width = width_of(lines.back());
      lines.back().push_back({std::string(kLabelWidth + kCellWidth - width, ' ')});
    }
    for (ReportPiece& piece : cell) lines.back().push_back(std::move(piece));
  }
  return lines;
}

// Measured gates by group, and headline values without a gate.
Lines grouped(const QualityReport& report, bool headlines) {
  Lines lines;
  for (const MetricGroup group : kMetricGroups) {
    std::vector<ReportLine> cells;
    for (const Metric& metric : quality_metrics()) {
      if (report.find(metric.key) == nullptr || group_of(metric) != group) continue;
      const bool is_gate = gate_on(report, metric.key) != nullptr;
      if (is_gate || (headlines && is_headline(metric))) cells.push_back(cell_of(report, metric));
    }
    append(lines, group_lines(group_name(group), std::move(cells)));
  }
  return lines;
}

struct MissedGate {
  const QualityReport* report = nullptr;
  const GateResult* gate = nullptr;
};

std::vector<MissedGate> missed_gates(std::span<const QualityReport> reports) {
  std::vector<MissedGate> missed;
  for (const QualityReport& report : reports) {
    for (const GateResult& gate : report.gates) {
      if (!gate.passed) missed.push_back({&report, &gate});
    }
  }
  return missed;
}

// Missed gates with the locations at which they are missed, in at most `room` lines. All gates have
// priority over the worst location of every gate, and these over the second worst.
Lines missed_lines(std::span<const QualityReport> reports, int room) {
  constexpr std::size_t kPlaces = 3;
  const std::vector<MissedGate> missed = missed_gates(reports);
  const auto shown = static_cast<std::size_t>(
      std::clamp<long>(room - (std::ssize(missed) > room ? 1 : 0), 0, std::ssize(missed)));
  std::vector<std::vector<std::string>> places;
  std::vector<std::size_t> taken(shown, 0);
  for (std::size_t i = 0; i < shown; ++i) {
    places.push_back(places_of_gate(*missed[i].report, *missed[i].gate));
  }
  long left = room - static_cast<long>(shown);
  if (shown < missed.size()) left = 0;
  for (std::size_t round = 0; round < kPlaces; ++round) {
    for (std::size_t i = 0; i < shown; ++i) {
      if (left <= 0 || places[i].size() <= round) continue;
      ++taken[i];
      --left;
    }
  }
  Lines lines;
  for (std::size_t i = 0; i < shown; ++i) {
    lines.push_back({{missed_text_of(*missed[i].report, *missed[i].gate), ReportTone::kBad}});
    for (std::size_t k = 0; k < taken[i]; ++k) lines.push_back({{"  " + places[i][k]}});
  }
  if (shown < missed.size() && room > 0) {
    lines.push_back({{"and " + std::to_string(missed.size() - shown) + " more"}});
  }
  return lines;
}

// Notes on properties that no gate measures: estimated soles may be misplaced, and a joint may be
// at a limit because the human's pose is beyond its range.
Lines notes_on(const QualityReport& report) {
  constexpr double kOften = 10.0;  // Percent of the frames.
  Lines notes;
  if (!report.estimated_soles.empty()) {
    notes.push_back({{"note: the soles are " + report.estimated_soles +
                      "; feet may float or sink by centimetres"}});
  }
  const auto& beyond = report.beyond_range;
  if (!beyond || beyond->frames_pct < kOften) return notes;
  notes.push_back(
      {{"note: " + beyond->joint + " is at its " + (beyond->at_upper ? "upper" : "lower") +
        " limit in " + number_text(beyond->frames_pct, 0) +
        " % of frames, where the human's pose is beyond its range"}});
  return notes;
}

Lines short_lines(const QualityReport& report) {
  ReportLine verdict = verdict_of(report);
  if (!report.robot.empty()) {
    verdict.push_back({" (" + report.robot + ", " + count_text(report.frames, "frame") + ")",
                       ReportTone::kFaint});
  }
  Lines groups = grouped(report, true);
  const bool has_gates = !report.gates.empty();
  const Lines notes = notes_on(report);
  // One line for the verdict, one for the legend.
  const int others = 1 + static_cast<int>(notes.size()) + (has_gates ? 1 : 0);
  const auto room = [&] { return kReportLines - others - static_cast<int>(groups.size()); };
  const auto missed = static_cast<int>(missed_gates({&report, 1}).size());
  if (room() < std::min(2 * missed, kReportLines)) groups = grouped(report, false);
  Lines lines = {std::move(verdict)};
  append(lines, missed_lines({&report, 1}, std::max(room(), 0)));
  append(lines, notes);
  append(lines, std::move(groups));
  if (has_gates) lines.push_back({{kLegend, ReportTone::kFaint}});
  return lines;
}

using Table = std::vector<std::vector<ReportPiece>>;

// A value and the mark of its gate, which is a column even without a gate.
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

// Pads the cells of a column to a common width. The first three columns are left-aligned.
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

// All metrics with a value in any report, by group, then in report order.
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

// A table with a header line, then one row per metric: its group, its name, its unit or its bound,
// and one value per motion with the mark of its gate.
// @param units  whether to show units instead of bounds, and also 95th percentiles.
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

// Compares several motions: metrics with missed gates, then headline metrics, then other metrics
// with gates while lines are left.
Lines side_by_side(std::span<const QualityReport> reports) {
  const auto rank = [reports](const Metric& metric) {
    bool is_gate = false;
    for (const QualityReport& report : reports) {
      const GateResult* gate = gate_on(report, metric.key);
      is_gate = is_gate || gate != nullptr;
      if (gate != nullptr && !gate->passed) return 0;
    }
    return is_headline(metric) ? 1 : is_gate ? 2 : 3;
  };
  Lines verdicts;
  for (const QualityReport& report : reports) verdicts.push_back(verdict_of(report));
  std::vector<const Metric*> metrics = metrics_by_group(reports);
  const bool has_gates = std::ranges::any_of(
      reports, [](const QualityReport& report) { return !report.gates.empty(); });
  // Every motion has a line for its verdict, so reports of many motions are longer.
  constexpr int kLinesOfMany = 15;
  const int all_lines = std::max(kReportLines, kLinesOfMany + static_cast<int>(verdicts.size()));
  // One line for the title, one for the legend.
  int room = all_lines - static_cast<int>(verdicts.size()) - 1 - (has_gates ? 1 : 0);
  const auto of_rank = [&](int wanted) {
    return static_cast<int>(std::ranges::count_if(
        metrics, [&](const Metric* metric) { return rank(*metric) == wanted; }));
  };
  const Lines missed =
      missed_lines(reports, std::clamp(room - of_rank(0) - of_rank(1), 0, kReportLines));
  room -= static_cast<int>(missed.size());
  std::vector<const Metric*> chosen;
  for (const int wanted : {0, 1, 2}) {
    for (const Metric* metric : metrics) {
      if (rank(*metric) == wanted && std::ssize(chosen) < room) chosen.push_back(metric);
    }
  }
  std::erase_if(metrics, [&chosen](const Metric* metric) {
    return std::ranges::find(chosen, metric) == chosen.end();
  });
  Lines lines = std::move(verdicts);
  append(lines, missed);
  append(lines, metric_table(reports, metrics, false));
  if (has_gates) lines.push_back({{kLegend, ReportTone::kFaint}});
  return lines;
}

// Shows all values.
Lines long_lines(std::span<const QualityReport> reports) {
  Lines lines;
  for (const QualityReport& report : reports) {
    ReportLine verdict = verdict_of(report);
    verdict.push_back({"; " + count_text(report.frames, "frame") + ", limits " + report.limits});
    lines.push_back(std::move(verdict));
  }
  const std::vector<const Metric*> metrics = metrics_by_group(reports);
  append(lines, metric_table(reports, metrics, true));
  constexpr int kAll = 1 << 20;
  const Lines missed = missed_lines(reports, kAll);
  if (!missed.empty()) {
    lines.push_back({});
    lines.push_back({{"gates missed:"}});
    append(lines, missed);
  }
  return lines;
}

}  // namespace

std::string report_text(std::span<const QualityReport> reports, const ReportStyle& style) {
  if (style.all) return rendered(long_lines(reports), style.colour);
  return rendered(reports.size() == 1 ? short_lines(reports.front()) : side_by_side(reports),
                  style.colour);
}

std::string report_text(std::span<const QualityReport> reports) {
  return report_text(reports, {});
}

}  // namespace retarget
