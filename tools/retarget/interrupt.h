#pragma once

#include <csignal>

namespace retarget::cli {

/// While one of these lives, Ctrl-C and SIGTERM set a flag instead of ending the process, so that
/// a run can stop between two frames and clean up. A second signal ends the process at once. Inside
/// another one's life, on any thread, it does nothing: the outermost has the signals.
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

/// In a process that works for another one: Ctrl-C is the other's affair, and SIGTERM, however often,
/// is what interrupted() tells of.
void leave_interrupts_to_parent();

/// Writing past a file size limit or into a closed pipe becomes an error instead of a signal.
void turn_write_signals_into_errors();

}  // namespace retarget::cli
