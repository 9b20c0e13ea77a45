#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/number_text.h"
#include "interrupt.h"
#include "retarget/error.h"
#include "retarget/solve.h"
#include "run/observer.h"

namespace retarget::cli {

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

/// What a run of one of many clips says, kept instead of printed.
struct ConsoleNotes {
  std::vector<std::string> warnings;  ///< One line each, with file, line and column.
  std::vector<std::pair<std::string, std::string>> lines;  ///< Of the summary: label and text.
};

/// What people read, on standard error. Results never come this way.
class Console : public Observer {
 public:
  explicit Console(bool quiet);
  /// Prints nothing and takes notes; they must live as long.
  explicit Console(ConsoleNotes& notes);

  /// Whether anybody reads the summary.
  [[nodiscard]] bool is_read() const override { return !quiet_ && notes_ == nullptr; }
  /// A line of the summary: a short label, then what there is to say. Silent when quiet.
  void line(std::string_view label, std::string_view text) override;
  void warn(const std::vector<Warning>& warnings, std::string_view file) override;
  /// Ctrl-C was pressed within an InterruptGuard.
  [[nodiscard]] bool is_stopped() const override { return InterruptGuard::interrupted(); }
  [[nodiscard]] std::shared_ptr<void> hold_interrupts() override {
    return std::make_shared<InterruptGuard>();
  }
  void progress(const Progress& progress) override;
  void fault(const Error& error) override { static_cast<void>(fail(error)); }
  /// Prints the error and gives its exit code.
  [[nodiscard]] ExitCode fail(const Error& error);

  /// A progress line that overwrites itself; only on a terminal, at most ten times a second.
  void progress(std::string_view what, int done, int total);
  /// The same with any text. Where there is no terminal, a line now and then.
  void status(std::string_view text) override;
  /// Removes the progress line.
  void end_progress() override;

 private:
  [[nodiscard]] std::string paint(std::string_view text, std::string_view code) const;
  /// A warning or an error as it is printed, but for colours.
  [[nodiscard]] std::string message(const std::string& text) const;
  /// Colours the word that says how bad a line is.
  [[nodiscard]] std::string paint_severity(std::string text) const;

  bool quiet_ = false;
  bool terminal_ = false;
  bool colour_ = false;
  ConsoleNotes* notes_ = nullptr;
  bool progress_shown_ = false;
  double last_progress_s_ = 0.0;
};

}  // namespace retarget::cli
