#include "retarget/text.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "base/utf8.h"

namespace retarget {
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

std::string printable_json(std::string_view json) {
  return replaced(json, [](std::uint32_t code) {
    std::array<char, 8> escape{};
    std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(code));
    return std::string(escape.data());
  });
}

}  // namespace retarget
