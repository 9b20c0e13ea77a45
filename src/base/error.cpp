#include "retarget/error.h"

#include <algorithm>

#include "retarget/text.h"

namespace retarget {
namespace {

Failure make_failure(ErrorKind kind, std::string file, std::string message, std::string hint) {
  return failure({kind, {std::move(file), 0, 0}, std::move(message), {}, std::move(hint)});
}

std::string place(std::string_view file, std::size_t line, std::size_t column) {
  std::string text = without_line_feeds(file);
  if (line > 0) {
    text.append(text.empty() ? "line " : ":").append(std::to_string(line));
    if (column > 0) text.append(":").append(std::to_string(column));
  }
  if (!text.empty()) text.append(": ");
  return text;
}

// @param kind  text in front of the message
std::string text_of_error(const Error& error, const char* kind, OptionSpelling spelling) {
  const Location& at = error.location;
  std::string text = place(at.file, at.line, at.column) + kind + full_message(error);
  if (!error.hint.empty()) text += "\n  hint: " + error.hint;
  return spell_options(text, spelling);
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

std::string option_as_field(std::string_view name) {
  std::string field(name);
  std::ranges::replace(field, '-', '_');
  return field;
}

std::string option_as_flag(std::string_view name) {
  return "--" + std::string(name);
}

std::string spell_options(std::string_view text, OptionSpelling spelling) {
  // The marks that OPTION() inserts.
  constexpr char kBegin = '\x0e', kEnd = '\x0f';
  std::string spelled;
  while (true) {
    const std::size_t begin = text.find(kBegin);
    const std::size_t end = begin == text.npos ? text.npos : text.find(kEnd, begin);
    if (end == text.npos) break;
    spelled.append(text.substr(0, begin)).append(spelling(text.substr(begin + 1, end - begin - 1)));
    text.remove_prefix(end + 1);
  }
  return spelled.append(text);
}

std::string full_message(const Error& error) {
  std::string text = error.message;
  for (const std::string& detail : error.details) text += "\n  - " + detail;
  return text;
}

std::string located_message(const Error& error, OptionSpelling spelling) {
  return text_of_error(error, "", spelling);
}

std::string describe(const Error& error, OptionSpelling spelling) {
  return text_of_error(error, "error: ", spelling);
}

std::string describe(const Warning& warning, std::string_view file, OptionSpelling spelling) {
  return spell_options(place(file, warning.line, warning.column) + "warning: " + warning.message,
                       spelling);
}

}  // namespace retarget
