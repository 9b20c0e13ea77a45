#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "retarget/text.h"

namespace retarget {

std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0U;
  };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
  const unsigned first = byte(0), second = byte(1);
  if (at >= text.size()) return 0;
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    // Exclude overlong forms and surrogates.
    const bool sound = follows(1) && follows(2) && (first != 0xE0 || second >= 0xA0) &&
                       (first != 0xED || second < 0xA0);
    return sound ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const bool sound = follows(1) && follows(2) && follows(3) &&
                       (first != 0xF0 || second >= 0x90) && (first != 0xF4 || second < 0x90);
    return sound ? 4 : 0;
  }
  return 0;
}

std::string_view take_until(std::string_view& text, char separator) {
  const std::string_view taken = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(taken.size() + 1, text.size()));
  return taken;
}

std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kBlank = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlank));
  text.remove_prefix(word.size());
  return word;
}

std::string valid_utf8(std::string_view bytes) {
  std::string text;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t length = utf8_length(bytes, at);
    text += length > 0 ? bytes.substr(at, length) : std::string_view("\xEF\xBF\xBD");
    at += length > 0 ? length : 1;
  }
  return text;
}

std::string hex_text(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (const char byte : bytes) {
    hex += kDigits[static_cast<unsigned char>(byte) >> 4U];
    hex += kDigits[static_cast<unsigned char>(byte) & 15U];
  }
  return hex;
}

std::optional<std::string> bytes_from_hex(std::string_view hex) {
  if (hex.size() % 2 != 0) return std::nullopt;
  std::string bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    unsigned byte = 0;
    const char* end = hex.data() + i + 2;
    const auto [rest, error] = std::from_chars(hex.data() + i, end, byte, 16);
    if (error != std::errc() || rest != end) return std::nullopt;
    bytes += static_cast<char>(byte);
  }
  return bytes;
}

namespace {

// Code point of a well-formed UTF-8 character.
std::uint32_t code_point(std::string_view character) {
  const auto lead = static_cast<unsigned char>(character.front());
  if (character.size() == 1) return lead;
  std::uint32_t code = lead & (0xFFU >> (character.size() + 1));
  for (const char byte : character.substr(1)) {
    code = (code << 6U) | (static_cast<unsigned char>(byte) & 0x3FU);
  }
  return code;
}

bool is_command(std::uint32_t code) {
  const auto within = [code](std::uint32_t first, std::uint32_t last) {
    return first <= code && code <= last;
  };
  if (code == '\n' || code == '\t') return false;
  return code < 0x20 || within(0x7F, 0x9F) || code == 0x061C || within(0x200E, 0x200F) ||
         within(0x2028, 0x202E) || within(0x2066, 0x2069);
}

// Replaces each control character by put(code). An invalid byte counts as a separate code.
template <typename Put>
std::string replaced(std::string_view text, const Put& put) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    const std::string_view part = text.substr(at, length == 0 ? 1 : length);
    const std::uint32_t code =
        length == 0 ? static_cast<unsigned char>(part.front()) : code_point(part);
    result += is_command(code) ? put(code) : std::string(part);
    at += part.size();
  }
  return result;
}

}  // namespace

std::string printable(std::string_view text) {
  return replaced(text, [](std::uint32_t) { return std::string("?"); });
}

std::string cut_short(std::string text, std::size_t length) {
  if (text.size() <= length) return text;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80) --length;
  return text.substr(0, length) + "...";
}

std::string xml_text(std::string_view text) {
  std::string result;
  const std::string valid = valid_utf8(printable(text));
  for (std::size_t at = 0; at < valid.size(); ++at) {
    switch (valid[at]) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\xEF':
        // U+FFFE and U+FFFF are valid in Unicode but not in XML.
        if (valid.compare(at, 3, "\xEF\xBF\xBE") == 0 ||
            valid.compare(at, 3, "\xEF\xBF\xBF") == 0) {
          result += '?';
          at += 2;
          break;
        }
        [[fallthrough]];
      default:
        result += valid[at];
    }
  }
  return result;
}

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string without_line_feeds(std::string_view text) {
  std::string line(text);
  std::ranges::replace(line, '\n', '?');
  return line;
}

std::string printable_json(std::string_view json) {
  return replaced(json, [](std::uint32_t code) {
    std::array<char, 8> escape{};
    std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(code));
    return std::string(escape.data());
  });
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

std::string number_text(double value, int decimals) {
  // The largest double has 309 digits before the point.
  std::array<char, 400> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                          std::chars_format::fixed, decimals);
  std::string text(digits.data(), end);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::string number_text(double value) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end};
}

std::optional<double> number_from_text(std::string_view text) {
  constexpr double kMaxExponent = 1e6;
  const auto value = parse_number<double>(text);
  return value && std::abs(*value) <= kMaxExponent ? value : std::nullopt;
}

std::optional<std::vector<double>> numbers_from_text(std::string_view text, char separator) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    const auto number = parse_number<double>(text.substr(begin, end - begin));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
    begin = end + 1;
  }
  return numbers;
}

namespace {

// Costs count half steps, so that a wrong case can cost less than a wrong letter.
constexpr int kLetterCost = 2;
// Longer names are not typing errors, and comparing them takes quadratic time.
constexpr std::size_t kMaxNameLength = 100;

int substitution_cost(char a, char b) {
  if (a == b) return 0;
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return lower(a) == lower(b) ? kLetterCost / 2 : kLetterCost;
}

// The edit distance, or any number of at least `max` if it is at least `max`.
int edit_distance(std::string_view a, std::string_view b, int max) {
  const std::size_t width = b.size() + 1;
  std::vector<int> before(width), last(width), row(width);
  for (std::size_t j = 0; j < width; ++j) last[j] = kLetterCost * static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = kLetterCost * static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + kLetterCost, row[j - 1] + kLetterCost,
                         last[j - 1] + substitution_cost(a[i - 1], b[j - 1])});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + kLetterCost);
    }
    // The distance cannot fall below the minimum of two consecutive rows.
    if (*std::ranges::min_element(row) >= max && *std::ranges::min_element(last) >= max) {
      return max;
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
  std::string nearest;
  if (name.size() > kMaxNameLength) return nearest;
  // A name with more than a third of its letters wrong is not a typing error.
  int best = kLetterCost * std::max<int>(1, static_cast<int>(name.size()) / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(name.size(), candidate.size());
    const std::size_t missing = longer - std::min(name.size(), candidate.size());
    if (kLetterCost * missing >= static_cast<std::size_t>(best)) continue;
    const int distance = edit_distance(name, candidate, best);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? std::string() : " (did you mean \"" + nearest + "\"?)";
}

std::string list_names(std::span<const std::string> names, std::size_t limit) {
  std::string text;
  const std::size_t shown = std::min(limit, names.size());
  for (std::size_t i = 0; i < shown; ++i) {
    if (i > 0) text += ", ";
    text += names[i];
  }
  if (names.size() > shown) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

namespace {

// Counts UTF-8 characters: continuation bytes take no column.
std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char c) { return (static_cast<unsigned>(c) & 0xC0U) != 0x80U; }));
}

// Wraps one line, which contains no line end.
void append_wrapped(std::string& out, std::string_view line, std::size_t used, std::size_t indent,
                    std::size_t width) {
  // Keep the indentation of the line.
  std::size_t at = std::min(line.find_first_not_of(' '), line.size());
  out.append(line.substr(0, at));
  std::size_t column = used + at;
  while (at < line.size()) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const std::size_t next = std::min(line.find_first_not_of(' ', end), line.size());
    out.append(line.substr(at, end - at));
    column += columns_of(line.substr(at, end - at));
    if (next == line.size()) return;
    const std::string_view word =
        line.substr(next, std::min(line.find(' ', next), line.size()) - next);
    const std::size_t blanks = next - end;
    if (column + blanks + columns_of(word) > width) {
      out += '\n';
      out.append(indent, ' ');
      column = indent;
    } else {
      out.append(blanks, ' ');
      column += blanks;
    }
    at = next;
  }
}

}  // namespace

std::string wrapped_text(std::string_view text, std::size_t used, std::size_t indent,
                         std::size_t width) {
  std::string out;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    append_wrapped(out, text.substr(begin, end - begin), begin == 0 ? used : 0, indent, width);
    if (end == text.size()) return out;
    out += '\n';
    begin = end + 1;
  }
}

}  // namespace retarget
