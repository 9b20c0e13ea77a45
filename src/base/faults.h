#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/text.h"

namespace retarget {

/// Collects the errors in a configuration file, so that the user can fix all of them at once. Only
/// the first 100 errors are kept, and only the first 4,000 bytes of each message: a malformed file
/// can hold millions, and names as long as the file itself.
class Faults {
 public:
  void add(std::string fault) {
    if (++count_ > kMaxListed) return;
    faults_.push_back(cut_short(std::move(fault), kMaxLength));
  }
  /// did_you_mean() for the fault that is added next. Empty when that fault will not be listed.
  [[nodiscard]] std::string suggestion(std::string_view name,
                                       std::span<const std::string> candidates) const {
    return count_ < kMaxListed ? did_you_mean(name, candidates) : std::string();
  }
  [[nodiscard]] bool empty() const { return count_ == 0; }

  /// A failure that holds the single fault, or a list of the first 100 faults under a line with
  /// their number.
  /// @param what  the faulty object, such as `the configuration`.
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
  std::size_t count_ = 0;  // Includes faults that are not kept.
};

/// Adds a file name to an input error that has none. For callers that know the input file when the
/// functions they call do not.
template <typename T>
[[nodiscard]] Result<T> located(Result<T> result, std::string_view file) {
  if (!result && result.error().kind == ErrorKind::kInput && result.error().location.file.empty()) {
    result.error().location.file = file;
  }
  return result;
}

}  // namespace retarget
