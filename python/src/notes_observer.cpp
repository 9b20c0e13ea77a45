#include "notes_observer.h"

#include <utility>

#include "raise.h"
#include "retarget/os.h"

namespace retarget::python {
namespace {

// Set by signals in a worker process.
volatile std::sig_atomic_t worker_is_stopped = 0;

}  // namespace

NotesObserver::NotesObserver(Watcher& watcher, nb::list notes)
    : watcher_(watcher), notes_(std::move(notes)) {}

void NotesObserver::line(std::string_view label, std::string_view text) {
  tell(std::string(label) + (label.empty() ? "" : ": ") + spell_options(text));
}

void NotesObserver::warn(const std::vector<Warning>& warnings, std::string_view file) {
  for (const Warning& each : warnings) tell(describe(each, file));
}

void NotesObserver::fault(const Error& error) {
  tell(describe(error));
}

bool NotesObserver::is_stopped() const {
  // A worker process must not call into Python.
  if (getpid() != process_) return worker_is_stopped != 0;
  return !watcher_.keep_going({}) || watcher_.is_stopped();
}

void NotesObserver::tell(const std::string& text) const {
  if (getpid() != process_) return;
  const HeldGil held;
  notes_.attr("append")(text_of(text));
}

void WarningsObserver::warn(const std::vector<Warning>& warnings, std::string_view file) {
  for (const Warning& each : warnings) told_.emplace_back(std::string(file), each);
}

void WarningsObserver::tell() const {
  for (const auto& [file, warning] : told_) python::warn(std::vector{warning}, file);
}

void begin_worker() {
  os::leave_interrupts_to_parent(worker_is_stopped);
}

}  // namespace retarget::python
