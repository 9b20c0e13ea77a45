#include "formats/bvh/source_text.h"

#include <algorithm>
#include <utility>

#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kMaxQuoteLength = 40;

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

std::string in_quotes(std::string_view text) {
  std::string quote = "\"";
  std::size_t at = 0;
  while (at < text.size() && quote.size() < kMaxQuoteLength) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0 || is_control(text[at])) {
      quote += "\\x" + hex_text(text.substr(at++, 1));
    } else {
      quote += text.substr(at, length);
      at += length;
    }
  }
  return quote + (at < text.size() ? "...\"" : "\"");
}

SourceText::SourceText(std::string_view text, std::string file)
    : text_(text), file_(std::move(file)) {}

std::size_t SourceText::line_of(std::size_t offset) const {
  return error_at(offset, {}).location.line;
}

Error SourceText::error_at(std::size_t offset, std::string message, std::string hint) const {
  std::size_t line = 1;
  std::size_t line_begin = 0;
  for (std::size_t i = 0; i < offset; ++i) {
    if (!is_line_end(text_[i])) continue;
    const bool pair = text_[i] == '\r' && i + 1 < offset && text_[i + 1] == '\n';
    if (pair) ++i;
    ++line;
    line_begin = i + 1;
  }
  return {ErrorKind::kInput,
          {file_, line, offset - line_begin + 1},
          std::move(message),
          {},
          std::move(hint)};
}

Failure SourceText::failure_at(std::size_t offset, std::string message, std::string hint) const {
  return failure(error_at(offset, std::move(message), std::move(hint)));
}

Warning SourceText::warning_at(std::size_t offset, std::string message) const {
  const Location place = error_at(offset, {}).location;
  return {place.line, place.column, std::move(message)};
}

std::string SourceText::found_at(std::size_t offset) const {
  if (offset >= text_.size()) return "the end of the file";
  if (text_[offset] == '\0') return "a NUL byte";
  if (is_line_end(text_[offset])) return "the end of the line";
  Scanner scanner(text_);
  scanner.move_to(offset);
  return in_quotes(scanner.token());
}

Failure SourceText::unexpected_at(std::size_t offset, std::string_view expected,
                                  std::string hint) const {
  return failure_at(offset, "expected " + std::string(expected) + ", found " + found_at(offset),
                    std::move(hint));
}

void Scanner::skip_space() {
  while (true) {
    while (!at_end() && is_space(text_[offset_])) ++offset_;
    if (!at_comment()) return;
    if (comment_count_++ == 0) first_comment_ = offset_;
    skip_line();
  }
}

void Scanner::skip_blanks() {
  while (!at_end() && is_space(text_[offset_]) && !is_line_end(text_[offset_])) ++offset_;
}

void Scanner::skip_line() {
  while (!at_end() && !is_line_end(text_[offset_])) ++offset_;
}

std::string_view Scanner::token() const {
  const auto is_brace = [](char c) { return c == '{' || c == '}'; };
  std::size_t end = offset_;
  while (end < text_.size() && !is_space(text_[end]) && !is_brace(text_[end])) ++end;
  if (end == offset_ && !at_end() && is_brace(text_[end])) ++end;
  return text_.substr(offset_, end - offset_);
}

std::string_view Scanner::word() const {
  const auto is_letter = [](char c) { return lower(c) >= 'a' && lower(c) <= 'z'; };
  std::size_t end = offset_;
  while (end < text_.size() && is_letter(text_[end])) ++end;
  return text_.substr(offset_, end - offset_);
}

bool Scanner::take(char c) {
  if (at_end() || text_[offset_] != c) return false;
  ++offset_;
  return true;
}

std::string_view Scanner::take_name() {
  const std::size_t begin = offset_;
  while (!at_end() && !is_line_end(text_[offset_]) && text_[offset_] != '{') ++offset_;
  std::string_view name = text_.substr(begin, offset_ - begin);
  while (!name.empty() && is_space(name.front())) name.remove_prefix(1);
  while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
  return name;
}

bool Scanner::at_comment() const {
  const std::string_view rest = text_.substr(offset_, 2);
  return rest.starts_with('#') || rest == "//";
}

}  // namespace retarget
