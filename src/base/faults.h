#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/suggest.h"
#include "retarget/error.h"

namespace retarget {

/// Collects what is wrong with a configuration file, so that a user mends it once. A file may hold
/// more faults than anybody reads, and names as long as itself: of both only the beginning is kept.
class Faults {
 public:
  void add(std::string fault) {
    if (++count_ > kMaxListed) return;
    if (fault.size() > kMaxLength) {
      std::size_t end = kMaxLength;
      // not within a character of several bytes
      while (end > 0 && (static_cast<unsigned char>(fault[end]) & 0xC0) == 0x80) --end;
      fault = fault.substr(0, end) + "...";
    }
    faults_.push_back(std::move(fault));
  }
  /// did_you_mean() for a fault that is added next; nothing where it will not be listed.
  [[nodiscard]] std::string suggestion(std::string_view name,
                                       std::span<const std::string> candidates) const {
    return count_ < kMaxListed ? did_you_mean(name, candidates) : std::string();
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }

  /// One fault as it is; several as a list under a line that counts them, the first 100 of them.
  /// @param what  what is at fault, such as `the configuration`.
  [[nodiscard]] Failure failure_in(const std::string& file, const std::string& what) const {
    if (count_ == 1) return config_failure(file, faults_.front());
    Failure failure = config_failure(file, std::to_string(count_) + " errors in " + what);
    std::vector<std::string>& details = failure.value().details;
    details = faults_;
    if (count_ > faults_.size()) {
      details.push_back("and " + std::to_string(count_ - faults_.size()) + " more");
    }
    return failure;
  }

 private:
  static constexpr std::size_t kMaxListed = 100;
  static constexpr std::size_t kMaxLength = 4000;

  std::vector<std::string> faults_;
  std::size_t count_ = 0;  // those that are not kept included
};

}  // namespace retarget
