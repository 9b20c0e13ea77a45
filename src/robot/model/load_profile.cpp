#include "robot/model/load_profile.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>
#include <vector>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/enum_names.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "robot/model/limits.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kKeys = {"name",
                                        "description",
                                        "source",
                                        "licence",
                                        "revision",
                                        "revision_date",
                                        "base",
                                        "joint_order",
                                        "limit_sets",
                                        "default_limits",
                                        "method_limits",
                                        "speed_limits",
                                        "speed_limits_source",
                                        "default_speed_limit",
                                        "torque_limits",
                                        "torque_limits_source",
                                        "rotor_inertias",
                                        "rotor_inertias_source",
                                        "coupled_joints",
                                        "t_pose",
                                        "soles",
                                        "soles_source",
                                        "soles_estimated",
                                        "allowed_self_contact",
                                        "joint_frames",
                                        "variants"};

const std::vector<std::string> kVariantKeys = {"description", "locked", "model", "bodies",
                                               "anchors"};
const std::vector<std::string> kSetKeys = {"source", "ranges"};
const std::vector<std::string> kSoleKeys = {"body", "points", "labels"};
const std::vector<std::string> kSideNames = {"left", "right"};

std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

// Whether a text is a date of the form YYYY-MM-DD.
bool is_date(const std::string& text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  const auto number_at = [&](std::size_t at, std::size_t length) {
    int value = 0;
    const char* const end = text.data() + at + length;
    const auto [stop, error] = std::from_chars(text.data() + at, end, value);
    return error == std::errc() && stop == end ? value : -1;
  };
  const int year = number_at(0, 4), month = number_at(5, 2), day = number_at(8, 2);
  if (year < 0 || month < 0 || day < 0) return false;
  return std::chrono::year_month_day(std::chrono::year(year),
                                     std::chrono::month(static_cast<unsigned>(month)),
                                     std::chrono::day(static_cast<unsigned>(day)))
      .ok();
}

// Reads the parts of a profile and collects all faults.
class ProfileReader {
 public:
  ProfileReader(const Json& json, const std::string& path, const Robot& bare, Faults& faults)
      : members_(json, faults),
        folder_(std::filesystem::path(path).parent_path()),
        body_names_(bare.body_names()),
        joint_names_(bare.joint_names()),
        bare_(bare),
        faults_(faults) {}

  RobotProfile read() {
    members_.check_keys(kKeys);
    const std::string name = members_.text("name");
    profile_.name = name;
    if (name.empty()) {
      faults_.add("\"name\" is missing or empty");
    } else if (!is_plain_name(name)) {
      // Output folders use the robot's name.
      faults_.add("\"name\" must be a valid folder name, found " + quoted(name));
    }
    profile_.description = members_.text("description");
    profile_.source = members_.text("source");
    profile_.licence = members_.text("licence");
    profile_.revision = members_.text("revision");
    read_revision_date();
    read_base();
    read_joint_order();
    read_limit_sets();
    profile_.default_limits = members_.text("default_limits");
    if (!profile_.default_limits.empty()) check_set(profile_.default_limits, "\"default_limits\"");
    read_method_limits();
    read_speed_limits();
    read_actuators();
    profile_.coupled_joints =
        couplings_from_json(members_.object("coupled_joints"), bare_, faults_);
    profile_.t_pose = joint_positions(members_.object("t_pose"), "\"t_pose\"");
    read_soles();
    read_allowed_self_contact();
    read_joint_frames();
    read_variants();
    return std::move(profile_);
  }

 private:
  // Returns a list entry that should be text; other types become text for the unknown-name message.
  static std::string name_in(const Json& json) {
    return json.is_string() ? json.get<std::string>() : short_text(json);
  }

  int body(const std::string& name, const std::string& what) {
    const auto found = bare_.find_body(name);
    if (!found) {
      faults_.add(what + ": the model has no body " + quoted(name) +
                  faults_.suggestion(name, body_names_));
    }
    return found.value_or(0);
  }

  bool is_joint(const std::string& name, const std::string& what) {
    if (bare_.find_joint(name)) return true;
    faults_.add(what + ": the model has no joint " + quoted(name) +
                faults_.suggestion(name, joint_names_));
    return false;
  }

  void read_revision_date() {
    const std::string date = members_.text("revision_date");
    profile_.revision_date = date;
    if (date.empty() || is_date(date)) return;
    faults_.add("\"revision_date\" must be a date YYYY-MM-DD, found " + quoted(date));
  }

  void read_joint_order() {
    const Json* names = members_.list("joint_order");
    if (names == nullptr) return;
    if (names->empty()) faults_.add("\"joint_order\" is empty");
    std::vector<std::string>& order = profile_.joint_order;
    for (const Json& entry : *names) {
      const std::string name = name_in(entry);
      if (!is_joint(name, "\"joint_order\"")) continue;
      if (std::ranges::find(order, name) != order.end()) {
        faults_.add("\"joint_order\" names " + quoted(name) + " twice");
      }
      order.push_back(name);
    }
  }

  void read_limit_sets() {
    for (const auto& [name, set] : members_.object("limit_sets").items()) {
      const std::string what = "limit set " + quoted(name);
      if (name.empty() || name == bare_.model_limits().name) {
        faults_.add(what + ": the name is reserved for the ranges of the model");
      }
      if (!set.is_object() || !set.contains("ranges")) {
        faults_.add(what + " must be {\"source\": text, \"ranges\": {joint: [lower, upper]}}");
        continue;
      }
      const JsonMembers members(set, faults_, what + ": ");
      members.check_keys(kSetKeys);
      LimitSet limits = ranges_from_json(set["ranges"], bare_, what, faults_);
      limits.name = name;
      limits.source = members.text("source");
      profile_.limit_sets.push_back(std::move(limits));
    }
  }

  void check_set(const std::string& name, const std::string& what) {
    std::vector<std::string> names = {bare_.model_limits().name};
    for (const LimitSet& set : profile_.limit_sets) names.push_back(set.name);
    if (std::ranges::find(names, name) == names.end()) {
      faults_.add(what + ": no limit set " + quoted(name) + faults_.suggestion(name, names));
    }
  }

  void read_method_limits() {
    const std::vector<std::string> methods = enum_names<Method>();
    for (const auto& [method, set] : members_.object("method_limits").items()) {
      if (std::ranges::find(methods, method) == methods.end()) {
        faults_.add("\"method_limits\": no method " + quoted(method) + "; the methods are " +
                    list_names(methods));
      }
      const std::string name = name_in(set);
      check_set(name, "\"method_limits\" of " + quoted(method));
      profile_.method_limits[method] = name;
    }
  }

  // Returns a positive number; otherwise adds a fault and returns 0.
  double positive(const Json& json, const std::string& what) {
    if (json.is_number() && json.get<double>() > 0.0) return json.get<double>();
    faults_.add(what + " must be a number above 0, found " + short_text(json));
    return 0.0;
  }

  void read_speed_limits() {
    profile_.speed_limits_source = members_.text("speed_limits_source");
    if (const Json* given = members_.find("default_speed_limit")) {
      profile_.default_speed_limit = positive(*given, "\"default_speed_limit\"");
    }
    profile_.speed_limits = positive_by_joint("speed_limits");
  }

  void read_actuators() {
    profile_.torque_limits_source = members_.text("torque_limits_source");
    profile_.torque_limits = positive_by_joint("torque_limits");
    profile_.rotor_inertias_source = members_.text("rotor_inertias_source");
    profile_.rotor_inertias = positive_by_joint("rotor_inertias");
  }

  // Reads {joint: number above 0}.
  std::map<std::string, double> positive_by_joint(const std::string& key) {
    std::map<std::string, double> values;
    const std::string what = quoted(key);
    for (const auto& [name, value] : members_.object(key).items()) {
      if (!is_joint(name, what)) continue;
      values[name] = positive(value, what + " of " + quoted(name));
    }
    return values;
  }

  // Reads positions by joint, rad or m. Reports positions in degrees.
  std::map<std::string, double> joint_positions(const Json& json, const std::string& what) {
    std::map<std::string, double> positions;
    for (const auto& [name, value] : json.items()) {
      if (!is_joint(name, what)) continue;
      if (!value.is_number() || !std::isfinite(value.get<double>())) {
        faults_.add(what + " of " + quoted(name) + " must be a number, found " + short_text(value));
        continue;
      }
      positions[name] = value.get<double>();
      const auto joint = static_cast<std::size_t>(bare_.find_joint(name).value());
      if (looks_like_degrees(bare_, joint, positions[name])) {
        faults_.add(what + " of " + quoted(name) + " is " + short_text(value) +
                    " rad, which looks like degrees: write it in radians");
      }
    }
    return positions;
  }

  void read_variants() {
    for (const auto& [name, entry] : members_.object("variants").items()) {
      const std::string what = "variant " + quoted(name);
      if (name.empty()) faults_.add("a variant has no name");
      const auto locked = entry.is_object() ? entry.find("locked") : entry.end();
      if (locked == entry.end() || !locked->is_object() || locked->empty()) {
        faults_.add(what + " must be {\"locked\": {joint: position, ...}}");
        continue;
      }
      const JsonMembers members(entry, faults_, what + ": ");
      members.check_keys(kVariantKeys);
      RobotVariant variant{
          name, members.text("description"), joint_positions(*locked, what), {}, {}, {}};
      // The variant's model must lie next to the profile, so that a robot's folder can be moved.
      if (const std::string model = members.text("model"); is_plain_name(model)) {
        variant.model = (folder_ / model).string();
      } else if (!model.empty()) {
        faults_.add(what + ": \"model\" must be a file in the profile's folder, found " +
                    quoted(model));
      }
      if (const Json* bodies = members.list("bodies")) {
        for (const Json& of_model : *bodies) {
          variant.bodies.push_back(name_in(of_model));
          body(variant.bodies.back(), what);
        }
      }
      read_anchors(members.object("anchors"), what, variant);
      profile_.variants.push_back(std::move(variant));
    }
  }

  void read_anchors(const Json& anchors, const std::string& what, RobotVariant& variant) {
    if (!anchors.empty() && variant.model.empty()) {
      faults_.add(what + ": \"anchors\" requires the variant to have its own \"model\"");
    }
    for (const auto& [name, point] : anchors.items()) {
      if (!is_joint(name, what + ": \"anchors\"")) continue;
      if (const auto anchor = vector_from(point)) {
        variant.anchors[name] = *anchor;
      } else {
        faults_.add(what + ": the anchor of " + quoted(name) + " must be [x, y, z], found " +
                    short_text(point));
      }
    }
  }

  void read_base() {
    const std::string base = members_.text("base");
    profile_.fixed_base = base == "fixed";
    if (base.empty() || base == "fixed" || base == "floating") return;
    faults_.add("\"base\" must be \"fixed\" or \"floating\", found " + quoted(base));
  }

  void read_soles() {
    profile_.soles_source = members_.text("soles_source");
    profile_.soles_estimated = members_.flag("soles_estimated");
    for (const auto& [side, entry] : members_.object("soles").items()) {
      const std::string what = "sole " + quoted(side);
      if (std::ranges::find(kSideNames, side) == kSideNames.end()) {
        faults_.add(what + ": expected \"left\" or \"right\"" +
                    faults_.suggestion(side, kSideNames));
      }
      if (!entry.is_object() || !entry.contains("body") || !entry.contains("points")) {
        faults_.add(what + " must be {\"body\": name, \"points\": [[x, y, z], ...]}");
        continue;
      }
      profile_.soles.push_back(sole(entry, side, what));
    }
  }

  Sole sole(const Json& entry, const std::string& side, const std::string& what) {
    Sole sole;
    sole.side = side;
    const JsonMembers members(entry, faults_, what + ": ");
    members.check_keys(kSoleKeys);
    sole.body = body(name_in(entry["body"]), what);
    const Json* points = members.list("points");
    if (points == nullptr) return sole;
    if (points->empty()) faults_.add(what + " has no points");
    for (const Json& json : *points) {
      if (const auto point = vector_from(json)) {
        sole.points.push_back(*point);
      } else {
        faults_.add(what + ": a point must be [x, y, z], found " + short_text(json));
      }
    }
    const Json* labels = members.list("labels");
    if (labels == nullptr) return sole;
    for (const Json& label : *labels) sole.labels.push_back(name_in(label));
    if (labels->size() != points->size()) {
      faults_.add(what + " has " + std::to_string(points->size()) + " points but " +
                  std::to_string(labels->size()) + " labels");
    }
    return sole;
  }

  void read_allowed_self_contact() {
    const Json* pairs = members_.list("allowed_self_contact");
    if (pairs == nullptr) return;
    for (const Json& pair : *pairs) {
      if (!pair.is_array() || pair.size() != 2) {
        faults_.add("\"allowed_self_contact\" must contain pairs of bodies, found " +
                    short_text(pair));
        continue;
      }
      profile_.allowed_self_contact.emplace_back(
          body(name_in(pair[0]), "\"allowed_self_contact\""),
          body(name_in(pair[1]), "\"allowed_self_contact\""));
    }
  }

  void read_joint_frames() {
    const Json* frames = members_.list("joint_frames");
    if (frames == nullptr) return;
    for (const Json& entry : *frames) {
      const std::string name = name_in(entry);
      const int frame = body(name, "\"joint_frames\"");
      const auto below = std::ranges::count(bare_.bodies(), frame, &RobotBody::parent);
      if (frame > 0 && below != 1) {
        faults_.add("\"joint_frames\": " + quoted(name) + " must contain one body, found " +
                    std::to_string(below));
      }
      profile_.joint_frames.push_back(name);
    }
  }

  const JsonMembers members_;
  const std::filesystem::path folder_;
  const std::vector<std::string> body_names_;
  const std::vector<std::string> joint_names_;
  const Robot& bare_;
  Faults& faults_;
  RobotProfile profile_;
};

}  // namespace

bool states_fixed_base(const std::string& path) {
  const auto json = load_json(path);
  return json && json->is_object() && text_at(*json, "base") == "fixed";
}

Result<RobotProfile> load_profile(const std::string& path, const Robot& bare) {
  TRY_ASSIGN(const auto json, load_json(path));
  if (!json.is_object()) return config_failure(path, "a robot profile must be a JSON object");
  Faults faults;
  RobotProfile profile = ProfileReader(json, path, bare, faults).read();
  if (!faults.empty()) return faults.failure_in(path, "the robot profile");
  return profile;
}

}  // namespace retarget
