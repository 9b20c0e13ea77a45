#pragma once

#include <string>
#include <utility>
#include <vector>

#include "retarget/base/result.h"

namespace retarget {

/// Collects what is wrong with a configuration file, so that a user mends it once.
class Faults {
 public:
  void add(std::string fault) { faults_.push_back(std::move(fault)); }
  [[nodiscard]] bool empty() const { return faults_.empty(); }

  /// One fault as it is; several as a list under a line that counts them.
  /// @param what  what is at fault, such as `the mapping`.
  [[nodiscard]] Failure failure_in(const std::string& file, const std::string& what) const {
    if (faults_.size() == 1) return config_failure(file, faults_.front());
    std::string text = std::to_string(faults_.size()) + " faults in " + what;
    for (const std::string& fault : faults_) text += "\n  - " + fault;
    return config_failure(file, text);
  }

 private:
  std::vector<std::string> faults_;
};

}  // namespace retarget
