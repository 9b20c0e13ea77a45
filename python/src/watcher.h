#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <mutex>
#include <optional>

#include "retarget/solve.h"

namespace retarget::python {

namespace nb = nanobind;

/// Reports progress to a Python callback and handles Python's signals (Ctrl-C), twenty times a
/// second, while the library works without the GIL. An exception from either stops the work.
class Watcher {
 public:
  /// @param progress  called with (stage, done, total); None: no reports.
  explicit Watcher(nb::object progress);

  /// Callable from any thread, without the GIL.
  bool keep_going(const Progress& now);
  /// Rethrows the exception that stopped the work. The GIL must be held.
  void rethrow();
  [[nodiscard]] bool is_stopped() const { return error_.has_value(); }

 private:
  nb::object progress_;
  std::mutex mutex_;  // Protects next_.
  std::chrono::steady_clock::time_point next_;
  std::optional<nb::python_error> error_;  // Protected by the GIL.
};

}  // namespace retarget::python
