#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/report.h"

namespace retarget {

/// Gathers what is wrong into runs of consecutive frames, apart for each joint or body.
class FaultList {
 public:
  FaultList(std::string_view metric, std::string_view unit) : metric_(metric), unit_(unit) {}

  /// Frames of one `where` come in rising order.
  void add(const std::string& where, int frame, double amount);
  /// Appends the `max` worst runs, the worst first, of equals the earliest; and how many there were.
  void move_to(QualityReport& report, std::size_t max);

 private:
  std::string metric_, unit_;
  std::vector<Fault> runs_;
  std::map<std::string, std::size_t> last_run_;  // by where
};

}  // namespace retarget
