#include "console.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <utility>

#include "retarget/error.h"
#include "retarget/os.h"
#include "retarget/text.h"

namespace retarget::cli {
namespace {

constexpr std::string_view kRed = "31";
constexpr std::string_view kYellow = "33";
constexpr std::string_view kFaint = "2";

// Label width of a summary line, and extra indentation of its continuation lines.
constexpr std::size_t kLabelWidth = 9;
constexpr std::size_t kFurther = 2;
// Indentation of continuation lines of warnings and errors.
constexpr std::size_t kMessageIndent = 4;

// Seconds between two progress lines.
constexpr double kTerminalPause = 0.1;
constexpr double kLinePause = 15.0;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool colours_allowed() {
  const char* no_color = std::getenv("NO_COLOR");
  return no_color == nullptr || *no_color == '\0';
}

}  // namespace

ExitCode exit_code(ErrorKind kind) {
  static_assert(kWrongUsage == exit_code_of(ErrorKind::kUsage) &&
                kBadInput == exit_code_of(ErrorKind::kInput) &&
                kBadConfig == exit_code_of(ErrorKind::kConfig) &&
                kInterruptedByUser == exit_code_of(ErrorKind::kInterrupted));
  return ExitCode{exit_code_of(kind)};
}

Console::Console(bool quiet)
    : quiet_(quiet),
      terminal_(is_terminal(os::kStandardError)),
      colour_(terminal_ && colours_allowed() && terminal_takes_colours(os::kStandardError)),
      // Without a terminal, the first status line can wait.
      last_progress_s_(terminal_ ? 0.0 : seconds_now()) {}

void Console::write_with(std::function<void(std::string_view)> write) {
  write_ = std::move(write);
}

void Console::put(std::string_view text) {
  if (write_) {
    write_(text);
  } else {
    std::fwrite(text.data(), 1, text.size(), stderr);
  }
}

std::string Console::paint(std::string_view text, std::string_view code) const {
  if (!colour_) return std::string(text);
  return "\033[" + std::string(code) + "m" + std::string(text) + "\033[0m";
}

std::string Console::paint_severity(std::string text) const {
  for (const auto& [word, code] : {std::pair(std::string_view("error:"), kRed),
                                   std::pair(std::string_view("warning:"), kYellow)}) {
    const std::size_t at = text.find(word);
    if (at != std::string::npos) return text.replace(at, word.size(), paint(word, code));
  }
  return text;
}

void Console::line(std::string_view label, std::string_view with_marks) {
  if (quiet_) return;
  const std::string text = without_line_feeds(spell_options(with_marks, option_as_flag));
  end_progress();
  std::string padded(label);
  // At least one space separates a long label from the text.
  padded.resize(std::max(padded.size() + 1, kLabelWidth), ' ');
  put(paint(padded, kFaint) + wrapped_text(printable(text), padded.size(), kLabelWidth + kFurther) +
      "\n");
}

// Programs that read messages expect one per line; a terminal would break long lines mid-word.
std::string Console::message(const std::string& text) const {
  return terminal_ ? wrapped_text(printable(text), 0, kMessageIndent) : printable(text);
}

void Console::warn(const std::vector<Warning>& warnings, std::string_view file) {
  if (quiet_) return;
  end_progress();
  for (const Warning& warning : warnings) {
    put(paint_severity(message(describe(warning, file, option_as_flag))) + "\n");
  }
}

ExitCode Console::fail(const Error& error) {
  end_progress();
  put(paint_severity(message(describe(error, option_as_flag))) + "\n");
  return exit_code(error.kind);
}

void Console::progress(const Progress& progress) {
  this->progress(progress.stage == Stage::kFrames ? "solving frame" : "fitting, percent",
                 progress.done, progress.total);
}

void Console::progress(std::string_view what, int done, int total) {
  if (!terminal_) return;
  status(std::string(what) + " " + std::to_string(done) + " / " + std::to_string(total));
}

void Console::status(std::string_view text) {
  if (quiet_) return;
  const double now = seconds_now(), pause_s = terminal_ ? kTerminalPause : kLinePause;
  if (now - last_progress_s_ < pause_s) return;
  last_progress_s_ = now;
  progress_shown_ = terminal_;
  put(terminal_ ? "\r" + std::string(text) + "\033[K" : std::string(text) + "\n");
}

void Console::end_progress() {
  if (progress_shown_) put("\r\033[K");
  progress_shown_ = false;
}

bool output_takes_colours() {
  return is_terminal(os::kStandardOutput) && colours_allowed() &&
         terminal_takes_colours(os::kStandardOutput);
}

}  // namespace retarget::cli
