#include "judge/quality/fault_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace retarget {

void FaultList::add(const std::string& where, int frame, double amount) {
  // NaN has no order; treat it as the worst value.
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

}  // namespace retarget
