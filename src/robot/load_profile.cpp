#include "robot/load_profile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/faults.h"
#include "base/json.h"
#include "retarget/base/suggest.h"
#include "robot/json_ranges.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kKeys = {"name",           "description",         "source",
                                        "licence",        "joint_order",         "limit_sets",
                                        "default_limits", "method_limits",       "speed_limits",
                                        "soles",          "allowed_self_contact"};

// reads the parts of a profile one by one and notes what is wrong with them
class ProfileReader {
 public:
  ProfileReader(const Json& json, const Robot& bare, Faults& faults)
      : json_(json), bare_(bare), faults_(faults) {}

  RobotProfile read() {
    check_keys();
    profile_.name = text("name", true);
    profile_.description = text("description", false);
    profile_.source = text("source", false);
    profile_.licence = text("licence", false);
    profile_.default_limits = text("default_limits", false);
    read_joint_order();
    read_limit_sets();
    read_method_limits();
    read_speed_limits();
    read_soles();
    read_allowed_self_contact();
    return std::move(profile_);
  }

 private:
  const Json* find(const std::string& key) {
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }

  void check_keys() {
    for (const auto& [key, value] : json_.items()) {
      if (std::ranges::find(kKeys, key) == kKeys.end()) {
        faults_.add("unknown key \"" + key + "\"" + did_you_mean(key, kKeys));
      }
    }
  }

  std::string text(const std::string& key, bool required) {
    const Json* value = find(key);
    if (value != nullptr && value->is_string()) return value->get<std::string>();
    if (value != nullptr) faults_.add("\"" + key + "\" must be a text, found " + value->dump());
    if (value == nullptr && required) faults_.add("\"" + key + "\" is missing");
    return {};
  }

  int body(const Json& json, const std::string& what) {
    const std::string name = json.is_string() ? json.get<std::string>() : json.dump();
    const auto found = bare_.find_body(name);
    if (!found) {
      faults_.add(what + ": the model has no body \"" + name + "\"" +
                  did_you_mean(name, bare_.body_names()));
    }
    return found.value_or(0);
  }

  // columns must be joints of the model, each at most once
  void read_joint_order() {
    const Json* json = find("joint_order");
    if (json == nullptr) return;
    if (!json->is_array() || json->empty()) {
      faults_.add("\"joint_order\" must be a list of joint names");
      return;
    }
    for (const Json& entry : *json) {
      const std::string name = entry.is_string() ? entry.get<std::string>() : entry.dump();
      if (!bare_.find_joint(name)) {
        faults_.add("\"joint_order\": the model has no joint \"" + name + "\"" +
                    did_you_mean(name, bare_.joint_names()));
      } else if (std::ranges::find(profile_.joint_order, name) != profile_.joint_order.end()) {
        faults_.add("\"joint_order\" names \"" + name + "\" twice");
      }
      profile_.joint_order.push_back(name);
    }
  }

  void read_limit_sets() {
    const Json* json = find("limit_sets");
    if (json == nullptr) return;
    if (!json->is_object()) {
      faults_.add("\"limit_sets\" must be an object of sets by name");
      return;
    }
    for (const auto& [name, set] : json->items()) {
      if (!set.is_object() || !set.contains("ranges")) {
        faults_.add("limit set \"" + name + "\" must be {\"source\": text, \"ranges\": {...}}");
        continue;
      }
      LimitSet limits =
          ranges_from_json(set["ranges"], bare_, "limit set \"" + name + "\"", faults_);
      limits.name = name;
      limits.source = set.value("source", std::string());
      profile_.limit_sets.push_back(std::move(limits));
    }
    if (!profile_.default_limits.empty()) check_set(profile_.default_limits, "\"default_limits\"");
  }

  void check_set(const std::string& name, const std::string& what) {
    std::vector<std::string> names = {bare_.model_limits().name};
    for (const LimitSet& set : profile_.limit_sets) names.push_back(set.name);
    if (std::ranges::find(names, name) == names.end()) {
      faults_.add(what + ": no limit set \"" + name + "\"" + did_you_mean(name, names));
    }
  }

  void read_method_limits() {
    const Json* json = find("method_limits");
    if (json == nullptr) return;
    for (const auto& [method, set] : json->items()) {
      const std::string name = set.is_string() ? set.get<std::string>() : set.dump();
      check_set(name, "\"method_limits\" of \"" + method + "\"");
      profile_.method_limits[method] = name;
    }
  }

  void read_speed_limits() {
    const Json* json = find("speed_limits");
    if (json == nullptr) return;
    for (const auto& [name, speed] : json->items()) {
      if (!bare_.find_joint(name)) {
        faults_.add("\"speed_limits\": the model has no joint \"" + name + "\"" +
                    did_you_mean(name, bare_.joint_names()));
      } else if (!speed.is_number() || !(speed.get<double>() > 0.0)) {
        faults_.add("\"speed_limits\" of \"" + name + "\" must be above 0, found " + speed.dump());
      } else {
        profile_.speed_limits[name] = speed.get<double>();
      }
    }
  }

  void read_soles() {
    const Json* json = find("soles");
    if (json == nullptr) return;
    for (const auto& [side, entry] : json->items()) {
      const std::string what = "sole \"" + side + "\"";
      if (!entry.is_object() || !entry.contains("body") || !entry.contains("points")) {
        faults_.add(what + " must be {\"body\": name, \"points\": [[x, y, z], ...]}");
        continue;
      }
      Sole sole;
      sole.side = side;
      sole.body = body(entry["body"], what);
      for (const Json& point : entry["points"]) {
        if (!is_point(point)) {
          faults_.add(what + ": a point must be [x, y, z], found " + point.dump());
          continue;
        }
        sole.points.emplace_back(point[0].get<double>(), point[1].get<double>(),
                                 point[2].get<double>());
      }
      for (const Json& label : entry.value("labels", Json::array())) {
        sole.labels.push_back(label.is_string() ? label.get<std::string>() : label.dump());
      }
      if (sole.points.empty()) faults_.add(what + " has no points");
      if (!sole.labels.empty() && sole.labels.size() != sole.points.size()) {
        faults_.add(what + " has " + std::to_string(sole.points.size()) + " points but " +
                    std::to_string(sole.labels.size()) + " labels");
      }
      profile_.soles.push_back(std::move(sole));
    }
  }

  static bool is_point(const Json& json) {
    return json.is_array() && json.size() == 3 && std::ranges::all_of(json, [](const Json& v) {
             return v.is_number() && std::isfinite(v.get<double>());
           });
  }

  void read_allowed_self_contact() {
    const Json* json = find("allowed_self_contact");
    if (json == nullptr) return;
    for (const Json& pair : *json) {
      if (!pair.is_array() || pair.size() != 2) {
        faults_.add("\"allowed_self_contact\" must hold pairs of bodies, found " + pair.dump());
        continue;
      }
      profile_.allowed_self_contact.emplace_back(body(pair[0], "\"allowed_self_contact\""),
                                                 body(pair[1], "\"allowed_self_contact\""));
    }
  }

  const Json& json_;
  const Robot& bare_;
  Faults& faults_;
  RobotProfile profile_;
};

}  // namespace

Result<RobotProfile> load_profile(const std::string& path, const Robot& bare) {
  const auto json = load_json(path);
  if (!json) return failure(json.error());
  if (!json->is_object()) return config_failure(path, "a robot profile must be a JSON object");
  Faults faults;
  RobotProfile profile = ProfileReader(*json, bare, faults).read();
  if (!faults.empty()) return faults.failure_in(path, "the robot profile");
  return profile;
}

}  // namespace retarget
