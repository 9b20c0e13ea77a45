#pragma once

#include <nanobind/nanobind.h>
#include <unistd.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/run.h"
#include "watcher.h"

namespace retarget::python {

namespace nb = nanobind;

/// Collects messages in a Python list, and stops the work on Ctrl-C. The work may fork; processes
/// other than the caller's report nothing.
class NotesObserver : public Observer {
 public:
  NotesObserver(Watcher& watcher, nb::list notes);

  void line(std::string_view label, std::string_view text) override;
  void warn(const std::vector<Warning>& warnings, std::string_view file) override;
  void fault(const Error& error) override;
  [[nodiscard]] bool is_stopped() const override;

 private:
  void tell(const std::string& text) const;

  Watcher& watcher_;
  nb::list notes_;
  const pid_t process_ = getpid();
};

/// Collects warnings while the GIL is released; tell() issues them through Python's `warnings`.
class WarningsObserver : public Observer {
 public:
  void warn(const std::vector<Warning>& warnings, std::string_view file) override;
  void tell() const;

 private:
  std::vector<std::pair<std::string, Warning>> told_;
};

/// Called first in each worker process: Python's handlers must not run there.
void begin_worker();

}  // namespace retarget::python
