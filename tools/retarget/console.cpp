#include "console.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace retarget::cli {
namespace {

constexpr std::string_view kRed = "31";
constexpr std::string_view kYellow = "33";
constexpr std::string_view kFaint = "2";

void put(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool colours_wanted() {
  const char* no_color = std::getenv("NO_COLOR");
  return no_color == nullptr || *no_color == '\0';
}

}  // namespace

ExitCode exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return kWrongUsage;
    case ErrorKind::kInput:
      return kBadInput;
    case ErrorKind::kConfig:
      return kBadConfig;
    case ErrorKind::kInterrupted:
      return kInterruptedByUser;
    case ErrorKind::kRun:
      break;
  }
  return kRunFailed;
}

Console::Console(bool quiet)
    : quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) != 0),
      colour_(terminal_ && colours_wanted()) {}

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

void Console::line(std::string_view label, std::string_view text) {
  if (quiet_) return;
  end_progress();
  std::string padded(label);
  padded.resize(9, ' ');
  put(paint(padded, kFaint) + std::string(text) + "\n");
}

void Console::warn(const std::vector<Warning>& warnings, std::string_view file) {
  if (quiet_) return;
  end_progress();
  for (const Warning& warning : warnings) put(paint_severity(describe(warning, file)) + "\n");
}

ExitCode Console::fail(const Error& error) {
  end_progress();
  put(paint_severity(describe(error)) + "\n");
  return exit_code(error.kind);
}

void Console::progress(std::string_view what, int done, int total) {
  if (quiet_ || !terminal_) return;
  const double now = seconds_now();
  if (now - last_progress_s_ < 0.1) return;
  last_progress_s_ = now;
  progress_shown_ = true;
  put("\r" + std::string(what) + " " + std::to_string(done) + " / " + std::to_string(total) +
      "\033[K");
}

void Console::end_progress() {
  if (progress_shown_) put("\r\033[K");
  progress_shown_ = false;
}

std::string count_text(long count, std::string_view noun) {
  return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

}  // namespace retarget::cli
