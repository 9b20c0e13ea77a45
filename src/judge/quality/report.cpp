#include <algorithm>
#include <cstddef>

#include "retarget/measure.h"
#include "retarget/report.h"

namespace retarget {

const MetricValue* QualityReport::find(std::string_view key) const {
  const auto found =
      std::ranges::find_if(values, [key](const MetricValue& v) { return v.metric->key == key; });
  return found == values.end() ? nullptr : &*found;
}

bool QualityReport::passed() const {
  return std::ranges::all_of(gates, &GateResult::passed);
}

void add_solver_failures(std::span<const SolverFailure> failures, QualityReport& report) {
  constexpr const char* kKey = "solver_failures";
  constexpr std::size_t kMost = 10;
  const auto count = static_cast<int>(failures.size());
  report.values.push_back({find_metric(kKey), static_cast<double>(count), std::nullopt});
  std::ranges::sort(report.values, {}, &MetricValue::metric);
  if (failures.empty()) return;
  report.fault_totals.push_back({kKey, count});
  for (const SolverFailure& failure : failures.first(std::min(failures.size(), kMost))) {
    const int frames = failure.end - failure.begin;
    report.faults.push_back({kKey, failure.solver, failure.begin, failure.end, failure.begin,
                             static_cast<double>(frames), frames == 1 ? "frame" : "frames"});
  }
}

}  // namespace retarget
