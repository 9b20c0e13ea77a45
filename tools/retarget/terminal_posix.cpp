// Signals and terminals of Linux and macOS.

#include <fcntl.h>
#include <unistd.h>
#include <atomic>
#include <csignal>

#include "console.h"
#include "retarget/os.h"

namespace retarget::cli {
namespace {

// Signal handlers can only access globals.
volatile std::sig_atomic_t interrupt_seen = 0;
volatile std::sig_atomic_t recalibration_asked = 0;
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

struct InterruptGuard::Before {
  struct sigaction interrupt {};
  struct sigaction terminate {};
};

InterruptGuard::InterruptGuard() : outermost_(guards++ == 0), before_(std::make_unique<Before>()) {
  if (!outermost_) return;
  interrupt_seen = 0;
  take_over(SIGINT, before_->interrupt);
  take_over(SIGTERM, before_->terminate);
}

InterruptGuard::~InterruptGuard() {
  --guards;
  if (!outermost_) return;
  ::sigaction(SIGINT, &before_->interrupt, nullptr);
  ::sigaction(SIGTERM, &before_->terminate, nullptr);
}

bool InterruptGuard::interrupted() {
  return interrupt_seen != 0;
}

void leave_interrupts_to_parent() {
  os::leave_interrupts_to_parent(interrupt_seen);
}

void turn_write_signals_into_errors() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

struct RecalibrationSignal::Before {
  struct sigaction action {};
};

RecalibrationSignal::RecalibrationSignal() : before_(std::make_unique<Before>()) {
  recalibration_asked = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { recalibration_asked = 1; };
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGUSR1, &action, &before_->action);
}

RecalibrationSignal::~RecalibrationSignal() {
  ::sigaction(SIGUSR1, &before_->action, nullptr);
}

bool RecalibrationSignal::take() {
  if (recalibration_asked == 0) return false;
  recalibration_asked = 0;
  return true;
}

std::vector<std::string> words_of_program(int argc, char** argv) {
  // A file that is opened later would otherwise take the number of a closed standard stream and
  // receive its messages. The streams stay unusable: input is open for writing, outputs for reading.
  for (const int stream : {os::kStandardInput, os::kStandardOutput, os::kStandardError}) {
    if (::fcntl(stream, F_GETFD) >= 0) continue;
    // The lowest free number is that of the stream, as those below it are open.
    static_cast<void>(::open("/dev/null", stream == os::kStandardInput ? O_WRONLY : O_RDONLY));
  }
  return {argv, argv + argc};
}

bool is_terminal(int stream) {
  return ::isatty(stream) != 0;
}

bool terminal_takes_colours(int stream) {
  return is_terminal(stream);
}

}  // namespace retarget::cli
