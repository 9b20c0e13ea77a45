#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "retarget/error.h"
#include "retarget/export.h"

// JSON with errors that have line and column. Programs that include this header, and fingerprint.h,
// need nlohmann-json 3.10 or later; no other header does.
namespace RETARGET_API retarget {

/// Parses JSON. Members keep their order.
///
/// Returns kConfig errors with line and column for syntax errors, for a key that occurs twice in an
/// object, for numbers beyond the range of double, and for text that would take too much time or memory to parse:
/// lists or objects nested more than 100 deep, objects with more than 2,000 members, more than
/// 200,000 members in total, and more than 16 MiB of text.
[[nodiscard]] Result<nlohmann::ordered_json> parse_json(std::string_view text,
                                                        const std::string& file);

/// Reads and parses a JSON file; see parse_json.
[[nodiscard]] Result<nlohmann::ordered_json> load_json(const std::string& path);

/// Formats JSON with an indentation of two spaces and a final newline. Terminal control characters
/// are escaped, invalid UTF-8 is replaced.
[[nodiscard]] std::string printable_dump(const nlohmann::ordered_json& json);

/// A value as JSON for a message, truncated when it is long.
[[nodiscard]] std::string short_text(const nlohmann::ordered_json& json);

/// Converts a JSON value to T: bool, a number, a string, or a list of them. Returns nothing for
/// JSON of another type and for integers that T cannot represent.
template <typename T>
[[nodiscard]] std::optional<T> value_from(const nlohmann::ordered_json& json) {
  if constexpr (std::is_same_v<T, bool>) {
    if (json.is_boolean()) return json.get<bool>();
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (json.is_string()) return json.get<std::string>();
  } else if constexpr (std::is_floating_point_v<T>) {
    if (json.is_number()) return json.get<T>();
  } else if constexpr (std::is_integral_v<T>) {
    const auto fitting = [](auto number) {
      return std::in_range<T>(number) ? std::optional<T>(static_cast<T>(number)) : std::nullopt;
    };
    // Test unsigned first: nlohmann counts unsigned numbers as integers, too.
    if (json.is_number_unsigned()) return fitting(json.get<std::uint64_t>());
    if (json.is_number_integer()) return fitting(json.get<std::int64_t>());
  } else {
    if (!json.is_array()) return std::nullopt;
    T values;
    for (const auto& each : json) {
      const auto value = value_from<typename T::value_type>(each);
      if (!value) return std::nullopt;
      values.push_back(*value);
    }
    return values;
  }
  return std::nullopt;
}

/// A text member of an object; empty if it is missing or has another type.
[[nodiscard]] std::string text_at(const nlohmann::ordered_json& json, const std::string& key);

/// Ends the key of the member with all bytes that put_name adds.
inline constexpr std::string_view kHexKeyEnd = "_hex";

/// Stores bytes that may not be valid UTF-8, such as a file name. Invalid bytes are replaced, and a
/// further member KEY_hex holds all bytes.
void put_name(nlohmann::ordered_json& json, const std::string& key, const std::string& bytes);

/// Reads a value stored by put_name; empty if there is none.
[[nodiscard]] std::string name_from(const nlohmann::ordered_json& json, const std::string& key);

}  // namespace retarget
