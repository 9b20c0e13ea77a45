#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/report.h"

namespace retarget {

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

}  // namespace retarget
