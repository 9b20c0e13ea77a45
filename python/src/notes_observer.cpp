#include "notes_observer.h"

#include <unistd.h>
#include <csignal>
#include <utility>

#include "raise.h"
#include "retarget/text.h"

namespace retarget::python {
namespace {

// Set by signals in a worker process.
volatile std::sig_atomic_t worker_is_stopped = 0;

// The parent asks a worker to stop; anyone else ends it, which fails only its clip.
void take_termination(int signal_number, siginfo_t* info, void* /*context*/) {
  if (info->si_pid == ::getppid()) {
    worker_is_stopped = 1;
    return;
  }
  std::signal(signal_number, SIG_DFL);
  ::kill(::getpid(), signal_number);
}

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
  const nb::gil_scoped_acquire acquired;
  notes_.attr("append")(text_of(text));
}

void begin_worker() {
  // The terminal sends Ctrl-C to the parent, which forwards it.
  std::signal(SIGINT, SIG_IGN);
  struct sigaction action {};
  action.sa_sigaction = take_termination;
  action.sa_flags = SA_SIGINFO;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGTERM, &action, nullptr);
}

}  // namespace retarget::python
