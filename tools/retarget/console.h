#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/run.h"
#include "retarget/solve.h"
#include "retarget/text.h"

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
  struct Before;
  std::unique_ptr<Before> before_;
};

/// While alive, a signal asks for a new calibration of a stream: SIGUSR1, or Ctrl-Break on Windows.
class RecalibrationSignal {
 public:
  RecalibrationSignal();
  ~RecalibrationSignal();
  RecalibrationSignal(const RecalibrationSignal&) = delete;
  RecalibrationSignal& operator=(const RecalibrationSignal&) = delete;

  /// Whether there was such a signal since the last call.
  [[nodiscard]] static bool take();

 private:
  struct Before;
  std::unique_ptr<Before> before_;
};

/// The words of the command line in UTF-8, starting with the program's name. Call it once, at the
/// start: it also prepares the standard streams, so that bytes are written unchanged.
[[nodiscard]] std::vector<std::string> words_of_program(int argc, char** argv);

/// Whether a standard stream (0, 1, 2) is a terminal.
[[nodiscard]] bool is_terminal(int stream);
/// Whether a terminal takes the escape sequences of colours.
[[nodiscard]] bool terminal_takes_colours(int stream);

/// For a worker process: ignores Ctrl-C, which its parent handles; SIGTERM of the parent, however
/// often it arrives, only sets the flag that interrupted() returns. SIGTERM of others ends it.
void leave_interrupts_to_parent();

/// Turns signals for writing past a file size limit or into a closed pipe into errors.
void turn_write_signals_into_errors();

/// Exit codes of the tool; README lists them for users.
enum ExitCode : int {
  kDone = 0,
  kRunFailed = 1,
  kWrongUsage = 2,
  kBadInput = 3,
  kBadConfig = 4,
  kInterruptedByUser = 130,
};

[[nodiscard]] ExitCode exit_code(ErrorKind kind);

/// Human-readable output on standard error. Results are never written here.
class Console : public Observer {
 public:
  explicit Console(bool quiet);

  /// Passes the text of all further messages to `write` instead of standard error.
  void write_with(std::function<void(std::string_view)> write);

  /// Returns true if summary lines are printed.
  [[nodiscard]] bool is_read() const override { return !quiet_; }
  /// Prints a summary line: a short label and its text. Silent when quiet.
  void line(std::string_view label, std::string_view text) override;
  void warn(const std::vector<Warning>& warnings, std::string_view file) override;
  /// Returns true after Ctrl-C within an InterruptGuard.
  [[nodiscard]] bool is_stopped() const override { return InterruptGuard::interrupted(); }
  [[nodiscard]] std::shared_ptr<void> hold_interrupts() override {
    return std::make_shared<InterruptGuard>();
  }
  void progress(const Progress& progress) override;
  void fault(const Error& error) override { static_cast<void>(fail(error)); }
  /// Prints the error and returns its exit code.
  [[nodiscard]] ExitCode fail(const Error& error);

  /// Prints a progress line that overwrites itself; only on a terminal, at most ten times a second.
  void progress(std::string_view what, int done, int total);
  /// The same with any text. Without a terminal, prints a line at longer intervals.
  void status(std::string_view text) override;
  /// Removes the progress line.
  void end_progress() override;

 private:
  [[nodiscard]] std::string paint(std::string_view text, std::string_view code) const;
  /// Returns the text of a warning or an error as printed, without colours.
  [[nodiscard]] std::string message(const std::string& text) const;
  /// Colours the severity word of a line.
  [[nodiscard]] std::string paint_severity(std::string text) const;
  void put(std::string_view text);

  bool quiet_ = false;
  bool terminal_ = false;
  bool colour_ = false;
  bool progress_shown_ = false;
  double last_progress_s_ = 0.0;
  std::function<void(std::string_view)> write_;  // Replaces standard error.
};

/// Whether standard output is a terminal that takes colours (NO_COLOR is not set).
[[nodiscard]] bool output_takes_colours();

}  // namespace retarget::cli
