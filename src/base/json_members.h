#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/json.h"

namespace retarget {

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
