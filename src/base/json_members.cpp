#include "base/json_members.h"

#include <fmt/format.h>

#include <algorithm>

namespace retarget {

using Json = JsonMembers::Json;

void JsonMembers::check_keys(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : json_.items()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    faults_.add(fmt::format("{}unknown key \"{}\"{}", where_, key, faults_.suggestion(key, known)));
  }
}

const Json* JsonMembers::find(const std::string& key) const {
  const auto found = json_.find(key);
  return found == json_.end() ? nullptr : &*found;
}

const Json* JsonMembers::member(const std::string& key, Json::value_t type,
                                const char* wanted) const {
  const Json* value = find(key);
  if (value == nullptr || value->type() == type) return value;
  faults_.add(
      fmt::format("{}\"{}\" must be {}, found {}", where_, key, wanted, short_text(*value)));
  return nullptr;
}

std::string JsonMembers::text(const std::string& key) const {
  const Json* value = member(key, Json::value_t::string, "a string");
  return value == nullptr ? std::string() : value->get<std::string>();
}

bool JsonMembers::flag(const std::string& key) const {
  const Json* value = member(key, Json::value_t::boolean, "true or false");
  return value != nullptr && value->get<bool>();
}

const Json* JsonMembers::list(const std::string& key) const {
  return member(key, Json::value_t::array, "a list");
}

const Json& JsonMembers::object(const std::string& key) const {
  static const Json kNone = Json::object();
  const Json* value = member(key, Json::value_t::object, "an object");
  return value == nullptr ? kNone : *value;
}

std::optional<Eigen::Vector3d> vector_from(const Json& json) {
  const auto values = value_from<std::vector<double>>(json);
  if (!values || values->size() != 3) return std::nullopt;
  return Eigen::Vector3d(values->data());
}

}  // namespace retarget
