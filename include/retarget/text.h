#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Formats a number with at most `decimals` decimals, without trailing zeros: 9.97, 30. Never uses
/// an exponent and does not depend on the locale.
[[nodiscard]] std::string number_text(double value, int decimals);
/// The shortest text from which the same number is read: 0.1, 1e-09, inf.
[[nodiscard]] std::string number_text(double value);

/// Parses the whole text as a number, independent of the locale. Returns nothing for any other
/// text.
template <typename Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(number) : std::nullopt;
}

/// Parses the whole text as a number with an absolute value of at most one million. In metres,
/// degrees or seconds, that is beyond any motion and still catches typing errors. Returns nothing
/// for any other text.
[[nodiscard]] std::optional<double> number_from_text(std::string_view text);

/// Parses finite numbers with a separator between them. Returns nothing for any other text.
[[nodiscard]] std::optional<std::vector<double>> numbers_from_text(std::string_view text,
                                                                   char separator);

/// The text without the UTF-8 byte order mark with which some editors begin files.
[[nodiscard]] inline std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

/// `1 frame`, `2 frames`.
[[nodiscard]] std::string count_text(std::integral auto count, std::string_view noun) {
  return std::to_string(count).append(" ").append(noun).append(count == 1 ? "" : "s");
}

/// Replaces by `?` each character that controls a terminal or changes the text direction: control
/// characters except tab and line feed (ASCII and U+0080 to U+009F), bidirectional marks, line and
/// paragraph separators. Names from files may contain any of them.
[[nodiscard]] std::string printable(std::string_view text);

/// Shortens a text to at most `length` bytes and `...`, without cutting a UTF-8 character in half.
[[nodiscard]] std::string cut_short(std::string text, std::size_t length);

/// Escapes text for an XML element or attribute: `<`, `>`, `&` and quotes become entities,
/// characters that are invalid in XML or control a terminal become `?`, invalid UTF-8 becomes
/// U+FFFD.
[[nodiscard]] std::string xml_text(std::string_view text);

/// Quotes a field of a CSV with a comma, a quote or a line end, as RFC 4180 requires.
[[nodiscard]] std::string csv_field(std::string_view text);

/// Replaces line feeds by `?`. Messages have one line, and the names of files in them may have
/// several.
[[nodiscard]] std::string without_line_feeds(std::string_view text);

/// Escapes the same characters in JSON text as `\u....`; the JSON value is unchanged. @pre
/// well-formed UTF-8
[[nodiscard]] std::string printable_json(std::string_view json);

/// The candidate nearest to `name` in Damerau-Levenshtein distance (a wrong case costs half as much
/// as a wrong letter). Returns an empty string when none is close enough.
[[nodiscard]] std::string nearest_name(std::string_view name,
                                       std::span<const std::string> candidates);

/// Returns ` (did you mean "X"?)` with a leading space, or an empty string.
[[nodiscard]] std::string did_you_mean(std::string_view name,
                                       std::span<const std::string> candidates);

/// Joins names as `a, b, c`. Beyond `limit` names it appends ` and N more`.
[[nodiscard]] std::string list_names(std::span<const std::string> names, std::size_t limit = 40);

/// Maximum line width of text for a terminal, in columns. Only a single longer word may exceed it.
inline constexpr std::size_t kTextWidth = 80;

/// Breaks a text at spaces so that no line exceeds `width` characters (not bytes). Existing line
/// ends are kept.
/// @param used    columns already occupied in front of the first line.
/// @param indent  spaces in front of each continuation line.
[[nodiscard]] std::string wrapped_text(std::string_view text, std::size_t used, std::size_t indent,
                                       std::size_t width = kTextWidth);

/// Removes the text up to a separator, and the separator, from the front of `text`; all of it if
/// there is none.
/// @return the text before the separator.
std::string_view take_until(std::string_view& text, char separator);

/// Removes the first word from a text with its spaces, tabs and line ends before it.
/// @return the word; empty: none is left.
std::string_view take_word(std::string_view& text);

/// Converts ASCII capitals to lower case; other bytes are unchanged.
[[nodiscard]] std::string lower_case(std::string text);

/// Length in bytes of the well-formed UTF-8 character at `at` (RFC 3629: no overlong forms, no
/// surrogates). Returns 0 for invalid UTF-8 and at the end of the text.
[[nodiscard]] std::size_t utf8_length(std::string_view text, std::size_t at);

/// Replaces each byte that is not part of a well-formed UTF-8 character by U+FFFD.
[[nodiscard]] std::string valid_utf8(std::string_view bytes);

/// Two hexadecimal digits per byte: `ff0a`.
[[nodiscard]] std::string hex_text(std::string_view bytes);

/// Decodes hex_text. Returns nothing for any other text.
[[nodiscard]] std::optional<std::string> bytes_from_hex(std::string_view hex);

}  // namespace retarget
