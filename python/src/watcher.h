#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <mutex>
#include <optional>

#include "retarget/solve.h"

namespace retarget::python {

namespace nb = nanobind;

/// Passes progress on to a callback of Python and sees to its signals (Ctrl-C) while the library works
/// without the GIL, twenty times a second. What either raises stops the work.
class Watcher {
 public:
  /// @param progress  called with (stage, done, total); None: nobody is told.
  explicit Watcher(nb::object progress);

  /// From any thread, without the GIL.
  bool keep_going(const Progress& now);
  /// Raises what stopped the work. With the GIL.
  void rethrow();
  [[nodiscard]] bool is_stopped() const { return error_.has_value(); }

 private:
  nb::object progress_;
  std::mutex mutex_;  // of next_
  std::chrono::steady_clock::time_point next_;
  std::optional<nb::python_error> error_;  // of the GIL
};

}  // namespace retarget::python
