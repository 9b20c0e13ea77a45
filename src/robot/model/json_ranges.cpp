#include "robot/model/json_ranges.h"

#include <fmt/format.h>

#include <cmath>

#include "base/json.h"

namespace retarget {
namespace {

bool is_range(const nlohmann::ordered_json& json) {
  return json.is_array() && json.size() == 2 && json[0].is_number() && json[1].is_number() &&
         std::isfinite(json[0].get<double>()) && std::isfinite(json[1].get<double>());
}

}  // namespace

LimitSet ranges_from_json(const nlohmann::ordered_json& json, const Robot& robot,
                          const std::string& what, Faults& faults) {
  LimitSet set = robot.model_limits();
  if (!json.is_object()) {
    faults.add(what + " must be an object of [lower, upper] by joint");
    return set;
  }
  for (const auto& [name, range] : json.items()) {
    const auto joint = robot.find_joint(name);
    // A variant's own model lacks its locked joints.
    if (!joint && robot.variant().locked.contains(name)) continue;
    if (!joint) {
      faults.add(fmt::format("{}: the model has no joint \"{}\"{}", what, name,
                             faults.suggestion(name, robot.joint_names())));
    } else if (!is_range(range)) {
      faults.add(fmt::format("{} of \"{}\" must be [lower, upper], found {}", what, name,
                             short_text(range)));
    } else if (range[0].get<double>() > range[1].get<double>()) {
      faults.add(
          fmt::format("{} of \"{}\": lower is above upper in {}", what, name, short_text(range)));
    } else {
      set.lower[*joint] = range[0].get<double>();
      set.upper[*joint] = range[1].get<double>();
    }
  }
  return set;
}

}  // namespace retarget
