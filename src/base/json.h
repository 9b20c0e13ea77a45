#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "retarget/error.h"
#include "retarget/json.h"

namespace retarget {

/// Refuses JSON text that takes too much time or memory to parse: lists or objects nested more than
/// 100 deep, objects with more than 2,000 members, more than 200,000 members in total, and more
/// than 16 MiB of text. These are kConfig errors with line and column. The check does not detect
/// malformed JSON.
[[nodiscard]] Result<void> check_json_bounds(std::string_view text, const std::string& file);

/// An object in an object; empty if it is missing or has another type.
[[nodiscard]] nlohmann::ordered_json object_at(const nlohmann::ordered_json& json,
                                               const std::string& key);

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
