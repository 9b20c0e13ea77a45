#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "judge/quality/report_parts.h"
#include "retarget/text.h"

namespace retarget {

void FaultList::add(const std::string& where, int frame, double amount) {
  // NaN cannot be sorted. It is the worst value.
  if (std::isnan(amount)) amount = std::numeric_limits<double>::infinity();
  const auto last = last_run_.find(where);
  if (last != last_run_.end() && runs_[last->second].end >= frame) {
    Fault& run = runs_[last->second];
    run.end = frame + 1;
    if (amount > run.amount) {
      run.amount = amount;
      run.worst_frame = frame;
    }
    return;
  }
  last_run_[where] = runs_.size();
  runs_.push_back({metric_, where, frame, frame + 1, frame, amount, unit_});
}

void FaultList::move_to(QualityReport& report, std::size_t max) {
  if (!runs_.empty()) report.fault_totals.push_back({metric_, static_cast<int>(runs_.size())});
  std::ranges::sort(runs_, [](const Fault& a, const Fault& b) {
    return std::tuple(-a.amount, a.begin, a.where) < std::tuple(-b.amount, b.begin, b.where);
  });
  runs_.resize(std::min(max, runs_.size()));
  report.faults.insert(report.faults.end(), runs_.begin(), runs_.end());
  runs_.clear();
  last_run_.clear();
}

namespace {

std::string_view colour_of(ReportTone tone) {
  constexpr std::array<std::string_view, 4> kColours = {"", "32", "31", "2"};
  return kColours[static_cast<std::size_t>(tone)];
}

int decimals_of(double value) {
  const double size = std::abs(value);
  return size >= 1000.0 ? 0 : size >= 100.0 ? 1 : size >= 1.0 ? 2 : 4;
}

// Formats a bound with about three significant digits; bounds scaled by a leg length have more.
std::string rounded(double bound) {
  const double size = std::abs(bound);
  return number_text(bound, size >= 100.0  ? 0
                            : size >= 10.0 ? 1
                            : size >= 1.0  ? 2
                            : size >= 0.1  ? 3
                                           : 4);
}

std::string bounds_phrase(const GateResult& gate) {
  if (gate.min && gate.max) return rounded(*gate.min) + " to " + rounded(*gate.max);
  return gate.max ? "at most " + rounded(*gate.max) : "at least " + rounded(*gate.min);
}

std::string frames_of(const Fault& fault) {
  if (fault.end == fault.begin + 1) return "frame " + std::to_string(fault.begin);
  return "frames " + std::to_string(fault.begin) + "-" + std::to_string(fault.end - 1) +
         ", worst " + std::to_string(fault.worst_frame);
}

// A detail of a missed gate that its faults do not contain; may be empty.
std::string detail_of(const QualityReport& report, const GateResult& gate) {
  if (!gate.value && report.source.empty()) return "no source of the motion is given";
  if (gate.metric == "trunk_lean_error_deg" && report.trunk_lean) {
    return "on average the robot leans by " + figure_text(report.trunk_lean->robot) +
           " degrees, the human by " + figure_text(report.trunk_lean->human);
  }
  if (gate.metric == "joint_at_limit_pct" && report.at_limit) {
    return report.at_limit->joint + " at its " + (report.at_limit->at_upper ? "upper" : "lower") +
           " limit";
  }
  if (gate.metric == "worst_limb_angle_deg" && !report.segments.empty()) {
    const auto worst = std::ranges::max_element(report.segments, {}, &SegmentAngle::mean_deg);
    return worst->name + ", 95th percentile " + figure_text(worst->p95_deg);
  }
  return {};
}

}  // namespace

std::string rendered(const std::vector<ReportLine>& lines, bool colour) {
  std::string text;
  for (const ReportLine& line : lines) {
    std::string shown;
    for (const ReportPiece& piece : line) {
      const std::string plain = printable(piece.text);
      const std::string_view code = colour ? colour_of(piece.tone) : std::string_view();
      if (code.empty() || plain.empty()) {
        shown += plain;
      } else {
        shown.append("\033[").append(code).append("m").append(plain).append("\033[0m");
      }
    }
    shown.erase(shown.find_last_not_of(' ') + 1);
    text += shown + "\n";
  }
  return text;
}

std::string figure_text(double value) {
  return number_text(value, decimals_of(value));
}

std::string figure_text(double value, const GateResult& gate) {
  constexpr int kMaxDecimals = 9;
  const auto same_as = [&](const std::optional<double>& bound, int decimals) {
    return bound && number_text(value, decimals) == number_text(*bound, decimals);
  };
  int decimals = decimals_of(value);
  while (!gate.passed && decimals < kMaxDecimals &&
         (same_as(gate.min, decimals) || same_as(gate.max, decimals))) {
    ++decimals;
  }
  return number_text(value, decimals);
}

const GateResult* gate_on(const QualityReport& report, std::string_view key) {
  const auto found = std::ranges::find(report.gates, key, &GateResult::metric);
  return found == report.gates.end() ? nullptr : &*found;
}

ReportPiece gate_mark(const GateResult* gate) {
  if (gate == nullptr) return {" "};
  if (!gate->value) return {"-", ReportTone::kFaint};
  return gate->passed ? ReportPiece{"+", ReportTone::kGood} : ReportPiece{"x", ReportTone::kBad};
}

std::string gate_bound_text(const GateResult& gate) {
  if (gate.min && gate.max) return rounded(*gate.min) + ".." + rounded(*gate.max);
  return gate.max ? "<=" + rounded(*gate.max) : ">=" + rounded(*gate.min);
}

ReportLine verdict_of(const QualityReport& report) {
  long kept = 0, missed = 0, unmeasured = 0;
  for (const GateResult& gate : report.gates) {
    ++(!gate.passed ? missed : gate.value ? kept : unmeasured);
  }
  const auto all = static_cast<long>(report.gates.size());
  ReportLine line = {{report.file + ": "}};
  line.push_back(
      {all == 0 ? "no gates" : std::to_string(kept) + " of " + count_text(all, "gate") + " passed",
       all == 0 || missed > 0 ? ReportTone::kPlain : ReportTone::kGood});
  if (missed > 0) {
    line.push_back({", "});
    line.push_back({std::to_string(missed) + " missed", ReportTone::kBad});
  }
  if (unmeasured > 0) line.push_back({", " + std::to_string(unmeasured) + " not measured"});
  if (!report.estimated_soles.empty()) line.push_back({", soles estimated"});
  return line;
}

std::string missed_text_of(const QualityReport& report, const GateResult& gate) {
  const std::string found = gate.value ? figure_text(*gate.value, gate) : "not measured";
  return report.file + ": " + gate.metric + " is " + found + ", expected " + bounds_phrase(gate);
}

std::vector<std::string> places_of_gate(const QualityReport& report, const GateResult& gate) {
  constexpr std::size_t kShown = 3;
  std::vector<std::string> places;
  if (std::string detail = detail_of(report, gate); !detail.empty()) places.push_back(detail);
  for (const Fault& fault : report.faults) {
    // Both self-collision metrics list the faults of all frames.
    const bool of_gate = fault.metric == gate.metric ||
                         (gate.metric == "self_1cm_pct" && fault.metric == "self_all_1cm_pct");
    if (!of_gate || places.size() >= kShown) continue;
    places.push_back(fault.where + ": " + figure_text(fault.amount) + " " + fault.unit + ", " +
                     frames_of(fault));
  }
  return places;
}

}  // namespace retarget
