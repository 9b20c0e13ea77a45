#include "interrupt.h"

#include <csignal>

namespace retarget::cli {
namespace {

// signal handlers can reach nothing but a global
volatile std::sig_atomic_t interrupt_seen = 0;

void note_interrupt(int signal_number) {
  interrupt_seen = 1;
  std::signal(signal_number, SIG_DFL);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupt_seen = 0;
  std::signal(SIGINT, note_interrupt);
  std::signal(SIGTERM, note_interrupt);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::interrupted() {
  return interrupt_seen != 0;
}

void turn_write_signals_into_errors() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace retarget::cli
