#include "retarget/base/result.h"

namespace retarget {
namespace {

Failure make_failure(ErrorKind kind, std::string file, std::string message, std::string hint) {
  Error error;
  error.kind = kind;
  error.file = std::move(file);
  error.message = std::move(message);
  error.hint = std::move(hint);
  return Failure(std::move(error));
}

std::string place(std::string_view file, std::size_t line, std::size_t column) {
  std::string text(file);
  if (line > 0) {
    text.append(text.empty() ? "line " : ":").append(std::to_string(line));
    if (column > 0) text.append(":").append(std::to_string(column));
  }
  if (!text.empty()) text.append(": ");
  return text;
}

}  // namespace

Failure input_failure(std::string file, std::string message, std::string hint) {
  return make_failure(ErrorKind::kInput, std::move(file), std::move(message), std::move(hint));
}

Failure config_failure(std::string file, std::string message, std::string hint) {
  return make_failure(ErrorKind::kConfig, std::move(file), std::move(message), std::move(hint));
}

Failure usage_failure(std::string message, std::string hint) {
  return make_failure(ErrorKind::kUsage, {}, std::move(message), std::move(hint));
}

Failure run_failure(std::string file, std::string message, std::string hint) {
  return make_failure(ErrorKind::kRun, std::move(file), std::move(message), std::move(hint));
}

Failure interrupted_failure() {
  return make_failure(ErrorKind::kInterrupted, {}, "interrupted; no output was written", {});
}

std::string describe(const Error& error) {
  std::string text = place(error.file, error.line, error.column) + "error: " + error.message;
  if (!error.hint.empty()) text += "\n  hint: " + error.hint;
  return text;
}

std::string describe(const Warning& warning, std::string_view file) {
  return place(file, warning.line, warning.column) + "warning: " + warning.message;
}

}  // namespace retarget
