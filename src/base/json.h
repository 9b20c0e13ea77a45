#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "retarget/error.h"

namespace retarget {

/// Parses JSON. Members keep their order; of duplicate keys the last one wins.
///
/// Returns kConfig errors with line and column for syntax errors, for numbers beyond the range of
/// double, and for text that check_json_bounds refuses.
[[nodiscard]] Result<nlohmann::ordered_json> parse_json(std::string_view text,
                                                        const std::string& file);

/// Reads and parses a JSON file; see parse_json.
[[nodiscard]] Result<nlohmann::ordered_json> load_json(const std::string& path);

/// Formats JSON with an indentation of two spaces and a final newline. Terminal control characters
/// are escaped, invalid UTF-8 is replaced.
[[nodiscard]] std::string printable_dump(const nlohmann::ordered_json& json);

/// A value as JSON for a message, truncated when it is long.
[[nodiscard]] std::string short_text(const nlohmann::ordered_json& json);

/// Refuses JSON text that takes too much time or memory to parse: lists or objects nested more than
/// 100 deep, objects with more than 2,000 members, more than 200,000 members in total, and more
/// than 16 MiB of text. These are kConfig errors with line and column. The check does not detect
/// malformed JSON.
[[nodiscard]] Result<void> check_json_bounds(std::string_view text, const std::string& file);

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

/// Reads optional members of a JSON object. A member of the wrong type is reported as a fault and
/// treated as missing.
class JsonMembers {
 public:
  using Json = nlohmann::ordered_json;

  /// @param json   an object; `json` and `faults` must outlive the reader.
  /// @param where  prefix of each fault, such as `variant "23": `.
  JsonMembers(const Json& json, Faults& faults, std::string where = {})
      : json_(json), faults_(faults), where_(std::move(where)) {}

  /// Reports every key that is not in `known` as a fault.
  void check_keys(const std::vector<std::string>& known) const;
  /// A member of any type; null when missing.
  [[nodiscard]] const Json* find(const std::string& key) const;
  [[nodiscard]] std::string text(const std::string& key) const;
  /// False when missing.
  [[nodiscard]] bool flag(const std::string& key) const;
  /// Null when missing.
  [[nodiscard]] const Json* list(const std::string& key) const;
  /// Empty when missing.
  [[nodiscard]] const Json& object(const std::string& key) const;

 private:
  const Json* member(const std::string& key, Json::value_t type, const char* wanted) const;

  const Json& json_;
  Faults& faults_;
  std::string where_;
};

/// Reads [x, y, z]. Returns nothing unless the value is a list of three numbers.
[[nodiscard]] std::optional<Eigen::Vector3d> vector_from(const nlohmann::ordered_json& json);

}  // namespace retarget
