#include "interrupt.h"

#include <atomic>
#include <csignal>

namespace retarget::cli {
namespace {

// Signal handlers can only access globals.
volatile std::sig_atomic_t interrupt_seen = 0;
// Number of live guards; the first one installs the handlers.
std::atomic<int> guards = 0;

// A second signal ends the process.
void note_interrupt(int signal_number) {
  interrupt_seen = 1;
  std::signal(signal_number, SIG_DFL);
}

// Signals that the parent process ignores, as nohup does, stay ignored.
void take_over(int signal_number, struct sigaction& old) {
  ::sigaction(signal_number, nullptr, &old);
  if (old.sa_handler == SIG_IGN) return;
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  sigemptyset(&action.sa_mask);
  ::sigaction(signal_number, &action, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() : outermost_(guards++ == 0) {
  if (!outermost_) return;
  interrupt_seen = 0;
  take_over(SIGINT, old_interrupt_);
  take_over(SIGTERM, old_terminate_);
}

InterruptGuard::~InterruptGuard() {
  --guards;
  if (!outermost_) return;
  ::sigaction(SIGINT, &old_interrupt_, nullptr);
  ::sigaction(SIGTERM, &old_terminate_, nullptr);
}

bool InterruptGuard::interrupted() {
  return interrupt_seen != 0;
}

void leave_interrupts_to_parent() {
  // The terminal sends Ctrl-C to the parent as well, which forwards it.
  std::signal(SIGINT, SIG_IGN);
  struct sigaction action {};
  action.sa_handler = [](int) { interrupt_seen = 1; };
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGTERM, &action, nullptr);
}

void turn_write_signals_into_errors() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace retarget::cli
