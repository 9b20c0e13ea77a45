#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// White space of BVH files. LF, CR LF and CR each end a line.
[[nodiscard]] constexpr bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
[[nodiscard]] constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}
[[nodiscard]] constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
/// NUL, escape and similar bytes, but not white space.
[[nodiscard]] constexpr bool is_control(char c) {
  return (static_cast<unsigned char>(c) < 0x20 && !is_space(c)) || c == 0x7f;
}

/// Compares texts ignoring the case of ASCII letters, in every locale.
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);

/// Quotes a text for a message: truncated to a readable length, with control bytes and invalid
/// UTF-8 as `\xNN`.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// The text of a file and its name. Turns byte offsets into errors and warnings with a position.
/// Lines and columns are counted only then. Holds a view of the text.
class SourceText {
 public:
  SourceText(std::string_view text, std::string file);

  [[nodiscard]] std::string_view text() const { return text_; }

  [[nodiscard]] std::size_t line_of(std::size_t offset) const;

  [[nodiscard]] Error error_at(std::size_t offset, std::string message,
                               std::string hint = {}) const;
  [[nodiscard]] Failure failure_at(std::size_t offset, std::string message,
                                   std::string hint = {}) const;
  [[nodiscard]] Warning warning_at(std::size_t offset, std::string message) const;

  /// The error `expected EXPECTED, found FOUND`, where FOUND is a quoted token, a NUL byte or the
  /// end of the file.
  [[nodiscard]] Failure unexpected_at(std::size_t offset, std::string_view expected,
                                      std::string hint = {}) const;
  [[nodiscard]] std::string found_at(std::size_t offset) const;

 private:
  std::string_view text_;
  std::string file_;
};

/// A position in a text that advances over white space, comments and tokens.
///
/// A token is a run of bytes without white space or braces, or one brace. A comment begins with `#`
/// or `//` where a token could begin and extends to the end of the line.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  [[nodiscard]] std::size_t offset() const { return offset_; }
  [[nodiscard]] bool at_end() const { return offset_ == text_.size(); }
  void move_to(std::size_t offset) { offset_ = offset; }

  /// Skips white space and comments, up to the next token.
  void skip_space();
  /// Skips white space up to the end of the line.
  void skip_blanks();
  /// Skips the rest of the line without its line end.
  void skip_line();

  /// The token at this position; empty at the end of the text and at white space.
  [[nodiscard]] std::string_view token() const;
  /// The run of ASCII letters at this position.
  [[nodiscard]] std::string_view word() const;
  /// Skips `c` if it is the next character.
  bool take(char c);

  /// Reads the rest of the line, or the part before a `{`, and returns it trimmed.
  std::string_view take_name();

  [[nodiscard]] bool at_comment() const;
  [[nodiscard]] std::size_t comment_count() const { return comment_count_; }
  [[nodiscard]] std::size_t first_comment() const { return first_comment_; }

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  std::size_t comment_count_ = 0;
  std::size_t first_comment_ = 0;
};

}  // namespace retarget
