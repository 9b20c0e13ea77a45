#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/json.h"

namespace retarget {

/// A value of a type: a bool, a number, a text, or a list of them. Nothing for JSON of another type,
/// and for a whole number that T cannot hold.
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
    // in this order: JSON's unsigned numbers count as integers as well
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

/// Reads members of a JSON object that may be left out. Of another type they count as left out, and
/// are a fault.
class JsonMembers {
 public:
  using Json = nlohmann::ordered_json;

  /// @param json   an object; it and faults must outlive the reader.
  /// @param where  before each fault, such as `variant "23": `.
  JsonMembers(const Json& json, Faults& faults, std::string where = {})
      : json_(json), faults_(faults), where_(std::move(where)) {}

  /// Other keys than these are faults.
  void check_keys(const std::vector<std::string>& known) const;
  /// Of any type; null where it is left out.
  [[nodiscard]] const Json* find(const std::string& key) const;
  [[nodiscard]] std::string text(const std::string& key) const;
  /// False where it is left out.
  [[nodiscard]] bool flag(const std::string& key) const;
  /// Null where it is left out.
  [[nodiscard]] const Json* list(const std::string& key) const;
  /// Empty where it is left out.
  [[nodiscard]] const Json& object(const std::string& key) const;

 private:
  const Json* member(const std::string& key, Json::value_t type, const char* wanted) const;

  const Json& json_;
  Faults& faults_;
  std::string where_;
};

/// [x, y, z]; nothing for what is no list of three numbers.
[[nodiscard]] std::optional<Eigen::Vector3d> vector_from(const nlohmann::ordered_json& json);

}  // namespace retarget
