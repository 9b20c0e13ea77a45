#pragma once

#include <csignal>

namespace retarget::cli {

/// While alive, makes Ctrl-C and SIGTERM set a flag instead of ending the process, so that a run
/// can stop between two frames and clean up. A second signal ends the process at once. Nested
/// guards, on any thread, have no effect: the outermost one handles the signals.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  [[nodiscard]] static bool interrupted();

 private:
  const bool outermost_;
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

/// For a worker process: ignores Ctrl-C, which its parent handles; SIGTERM, however often it
/// arrives, only sets the flag that interrupted() returns.
void leave_interrupts_to_parent();

/// Turns signals for writing past a file size limit or into a closed pipe into errors.
void turn_write_signals_into_errors();

}  // namespace retarget::cli
