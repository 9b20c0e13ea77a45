// `retarget robots`: lists, shows and checks robots, and makes new ones.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/data_folder.h"
#include "base/file.h"
#include "base/printable.h"
#include "base/utf8.h"
#include "commands.h"
#include "retarget/ik_config.h"
#include "rig/check_robot.h"
#include "rig/make_robot.h"
#include "robot/load_robot.h"
#include "robot_mapping.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Result<fs::path> data_folder_of(const RobotsOptions& options) {
  const std::string& chosen = options.common.data_dir;
  return find_data_folder(chosen.empty() ? std::nullopt : std::optional<std::string>(chosen));
}

// where a robot and its mappings are; no mappings: none
struct RobotPlace {
  RobotFiles files;
  std::optional<MappingFiles> mappings;
};

RobotPlace place_of(const RobotFiles& files, const fs::path& data_folder) {
  const fs::path named = files.model.parent_path();
  const fs::path folder = named.empty() ? fs::path(".") : named;
  auto found =
      find_mappings({}, "gmr", folder, data_folder, fs::absolute(folder).filename().string());
  return {files, found ? std::optional<MappingFiles>(std::move(*found)) : std::nullopt};
}

Result<RobotPlace> find_place(const std::string& robot, const fs::path& data_folder) {
  const auto files = find_robot(robot, data_folder / "robots");
  if (!files) return failure(files.error());
  return place_of(*files, data_folder);
}

// heights in the zero configuration, metres
struct Heights {
  double sole = 0.0;   // from the soles up to the root body's origin
  double whole = 0.0;  // from the soles up to the highest point that is known
};

double top_of(const CollisionShape& shape, const Pose& world_from_body) {
  const Pose world_from_shape = world_from_body * shape.body_from_shape;
  const Eigen::Vector3d up = world_from_shape.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  double reach = shape.radius;
  if (shape.type == CollisionShape::Type::kCapsule) reach += shape.half_length * std::abs(up.z());
  if (shape.type == CollisionShape::Type::kBox) reach = up.cwiseAbs().dot(shape.half_size);
  return world_from_shape.translation.z() + reach;
}

std::optional<Heights> heights_of(const Robot& robot) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, robot.zero_configuration(), world_from_body);
  double lowest = INFINITY;
  for (const Sole& sole : robot.profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) {
      lowest = std::min(lowest, (world_from_body[sole.body] * point).z());
    }
  }
  if (!std::isfinite(lowest)) return std::nullopt;
  double highest = world_from_body[robot.root_body()].translation.z();
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    highest = std::max(highest, world_from_body[b].translation.z());
  }
  for (const CollisionShape& shape : robot.collision_shapes()) {
    highest = std::max(highest, top_of(shape, world_from_body[shape.body]));
  }
  return Heights{world_from_body[robot.root_body()].translation.z() - lowest, highest - lowest};
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json joints_json(const Robot& robot) {
  Json joints = Json::array();
  for (const int index : robot.output_joints()) {
    const RobotJoint& joint = robot.joints()[index];
    Json limits = Json::object();
    limits["model"] = {number_or_null(robot.model_limits().lower[index]),
                       number_or_null(robot.model_limits().upper[index])};
    for (const LimitSet& set : robot.profile().limit_sets) {
      limits[set.name] = {number_or_null(set.lower[index]), number_or_null(set.upper[index])};
    }
    joints.push_back({{"name", joint.name},
                      {"body", robot.bodies()[joint.body].name},
                      {"type", joint.type == RobotJoint::Type::kHinge ? "hinge" : "slide"},
                      {"limits", limits},
                      {"speed_limit", number_or_null(robot.speed_limit(index))}});
  }
  return joints;
}

Json mapping_json(const IkTables& tables) {
  Json rows = Json::array();
  for (const IkRow& row : tables.tables[0].rows) {
    const auto second = std::ranges::find(tables.tables[1].rows, row.body, &IkRow::body);
    const bool has_second = second != tables.tables[1].rows.end();
    const double* scale = tables.find_scale(row.bone);
    rows.push_back(
        {{"body", row.body},
         {"bone", row.bone},
         {"scale", scale == nullptr ? Json() : Json(*scale)},
         {"pass1", {row.position_weight, row.rotation_weight}},
         {"pass2", has_second ? Json{second->position_weight, second->rotation_weight} : Json()}});
  }
  return rows;
}

Json robot_json(const Robot& robot, const std::optional<MappingFiles>& mappings) {
  Json json;
  json["name"] = robot.name();
  json["description"] = robot.profile().description;
  json["source"] = robot.profile().source;
  json["licence"] = robot.profile().licence;
  const auto heights = heights_of(robot);
  json["height_m"] = heights ? Json(heights->whole) : Json();
  json["sole_height_m"] = heights ? Json(heights->sole) : Json();
  json["root_body"] = robot.bodies()[robot.root_body()].name;
  json["default_limits"] = robot.limits_for("");
  json["joints"] = joints_json(robot);
  json["mapping_file"] = mappings ? Json(mappings->of_lafan1) : Json();
  if (mappings) {
    const auto tables = load_ik_tables(mappings->of_lafan1);
    json["mapping"] = tables ? mapping_json(*tables) : Json();
    // of sources that are not LAFAN1, where it is another one
    if (!mappings->of_others.empty()) json["mapping_file_of_others"] = mappings->of_others;
  }
  return json;
}

// for a terminal as well
std::string json_text(const Json& json) {
  return printable_json(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size() + 1, width), ' ');
  return text;
}

std::string range_text(const Json& range) {
  const auto end = [](const Json& value) {
    return value.is_null() ? std::string("none") : number_text(value.get<double>(), 4);
  };
  return end(range[0]) + " " + end(range[1]);
}

std::string plain_text(const Json& json) {
  std::string text =
      json["name"].get<std::string>() + ": " + json["description"].get<std::string>();
  text += "\nsource   " + json["source"].get<std::string>() + "\nlicence  " +
          json["licence"].get<std::string>() + "\n";
  if (!json["height_m"].is_null()) {
    text += "height   " + number_text(json["height_m"].get<double>(), 3) + " m; root body \"" +
            json["root_body"].get<std::string>() + "\" " +
            number_text(json["sole_height_m"].get<double>(), 3) + " m above the soles\n";
  }
  text +=
      "\njoints in the order of the output columns, limits and speeds in rad or m, per second\n";
  std::string head = padded("", 4) + padded("joint", 32);
  const Json& joints = json["joints"];
  if (!joints.empty()) {
    for (const auto& [set, range] : joints[0]["limits"].items()) head += padded(set, 20);
  }
  text += head + "speed\n";
  int number = 0;
  for (const Json& joint : joints) {
    text += padded(std::to_string(++number), 4) + padded(joint["name"].get<std::string>(), 32);
    for (const auto& [set, range] : joint["limits"].items()) text += padded(range_text(range), 20);
    const Json& speed = joint["speed_limit"];
    text += (speed.is_null() ? "none" : number_text(speed.get<double>(), 2)) + "\n";
  }
  if (json["mapping_file"].is_null()) return text + "\nno mapping\n";
  text += "\nmapping  " + json["mapping_file"].get<std::string>() + "\n";
  if (json.contains("mapping_file_of_others")) {
    text += "         of sources that are not LAFAN1: " +
            json["mapping_file_of_others"].get<std::string>() + "\n";
  }
  text += padded("body", 32) + padded("bone", 16) + padded("scale", 8) +
          "weights of position and rotation, both passes\n";
  if (!json.contains("mapping") || json["mapping"].is_null()) return text;
  for (const Json& row : json["mapping"]) {
    text += padded(row["body"].get<std::string>(), 32) + padded(row["bone"].get<std::string>(), 16);
    text += padded(row["scale"].is_null() ? "-" : number_text(row["scale"].get<double>(), 4), 8);
    for (const char* pass : {"pass1", "pass2"}) {
      const Json& weights = row[pass];
      text += weights.is_null() ? padded("-", 10)
                                : padded(number_text(weights[0].get<double>(), 2) + " " +
                                             number_text(weights[1].get<double>(), 2),
                                         10);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

Result<std::string> list(const RobotsOptions& options) {
  const auto data_folder = data_folder_of(options);
  if (!data_folder) return failure(data_folder.error());
  const fs::path folder = *data_folder / "robots";
  Json all = Json::array();
  std::string text;
  for (const std::string& name : list_robots(folder)) {
    const auto place = find_place(name, *data_folder);
    if (!place) return failure(place.error());
    const auto robot = load_robot(place->files.model.string(), place->files.profile.string());
    if (!robot) return failure(robot.error());
    const auto heights = heights_of(**robot);
    const std::size_t joints = (*robot)->output_joints().size();
    all.push_back({{"name", name},
                   {"description", (*robot)->profile().description},
                   {"joints", joints},
                   {"height_m", heights ? Json(heights->whole) : Json()},
                   {"mapping", place->mappings.has_value()},
                   {"licence", (*robot)->profile().licence}});
    text += padded(name, 26) + padded(count_text(static_cast<long>(joints), "joint"), 12) +
            padded(heights ? number_text(heights->whole, 2) + " m" : "-", 8) +
            (*robot)->profile().description + (place->mappings ? "" : " (no mapping)") + "\n";
  }
  return options.json ? json_text(all) : printable(text);
}

Result<std::string> show(const RobotsOptions& options) {
  const auto data_folder = data_folder_of(options);
  if (!data_folder) return failure(data_folder.error());
  const auto place = find_place(options.robot, *data_folder);
  if (!place) return failure(place.error());
  const auto robot = load_robot(place->files.model.string(), place->files.profile.string());
  if (!robot) return failure(robot.error());
  const Json json = robot_json(**robot, place->mappings);
  return options.json ? json_text(json) : printable(plain_text(json));
}

bool is_model_file(const std::string& path) {
  std::error_code ignored;
  const fs::path extension = fs::path(path).extension();
  return (extension == ".xml" || extension == ".urdf") && fs::is_regular_file(path, ignored);
}

// what a check says of the robot with each of its mappings
void add_findings(const Robot& robot, const std::optional<MappingFiles>& mappings,
                  std::vector<RobotFinding>& findings) {
  std::vector<std::string> files = {mappings ? mappings->of_lafan1 : std::string()};
  if (mappings && !mappings->of_others.empty()) files.push_back(mappings->of_others);
  for (const std::string& file : files) {
    std::optional<IkTables> tables;
    if (!file.empty()) {
      auto read = load_ik_tables(file);
      if (!read) findings.push_back({true, describe(read.error(), option_as_flag)});
      if (read) tables = std::move(*read);
    }
    for (RobotFinding& finding : check_robot(robot, tables ? &*tables : nullptr)) {
      const bool known = std::ranges::any_of(
          findings, [&](const RobotFinding& other) { return other.text == finding.text; });
      if (known) continue;
      // what only the second mapping is to blame for
      if (file != files.front())
        finding.text = fs::path(file).filename().string() + ": " + finding.text;
      findings.push_back(std::move(finding));
    }
  }
}

// what is wrong, where a file cannot even be read as well
Result<std::vector<RobotFinding>> examine(const RobotsOptions& options) {
  const auto data_folder = data_folder_of(options);
  if (!data_folder) return failure(data_folder.error());
  RobotPlace place;
  if (is_model_file(options.robot)) {
    const fs::path profile = fs::path(options.robot).parent_path() / "robot.json";
    std::error_code ignored;
    place = place_of({options.robot, fs::is_regular_file(profile, ignored) ? profile : fs::path(),
                      options.robot},
                     *data_folder);
  } else {
    const auto found = find_place(options.robot, *data_folder);
    if (!found) return failure(found.error());
    place = *found;
  }
  std::vector<RobotFinding> findings;
  auto robot = load_robot(place.files.model.string(), place.files.profile.string());
  if (!robot) {
    // a profile at fault does not hide what is odd about the model
    auto bare = load_robot(place.files.model.string());
    if (!bare) return failure(bare.error());
    findings.push_back({true, full_message(robot.error())});
    robot = std::move(bare);
  }
  for (const std::string& warning : (*robot)->warnings()) findings.push_back({false, warning});
  add_findings(**robot, place.mappings, findings);
  std::ranges::stable_sort(findings, std::ranges::greater(), &RobotFinding::fault);
  return findings;
}

ExitCode check(const RobotsOptions& options, Console& console) {
  const auto findings = examine(options);
  if (!findings) return console.fail(findings.error());
  std::string text;
  for (const RobotFinding& finding : *findings) {
    text += (finding.fault ? "fault: " : "note: ") + finding.text + "\n";
  }
  const auto faults = std::ranges::count(*findings, true, &RobotFinding::fault);
  const auto notes = static_cast<long>(findings->size()) - faults;
  text +=
      options.robot + ": " + count_text(faults, "fault") + ", " + count_text(notes, "note") + "\n";
  const auto written = write_file("-", printable(text));
  if (!written) return console.fail(written.error());
  return faults > 0 ? kBadConfig : kDone;
}

// whether a file is in a folder or below it, links followed
bool is_below(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const fs::path of_file = fs::weakly_canonical(file, error);
  const fs::path of_folder = fs::weakly_canonical(folder, error);
  if (error) return false;
  return std::ranges::mismatch(of_folder, of_file).in1 == of_folder.end();
}

ExitCode add(const RobotsOptions& options, Console& console) {
  const std::string& name = options.robot;
  if (name.empty() || name.starts_with('.') || valid_utf8(name) != name ||
      name.find_first_of("/\\") != std::string::npos) {
    return console.fail(
        usage_failure("\"" + name + "\" cannot be a robot's name: it becomes a folder's").value());
  }
  if (is_below(options.model, fs::path(options.output) / name)) {
    return console.fail(usage_failure("\"" + options.model +
                                          "\" lies in the folder that would be " + "replaced, \"" +
                                          name + "\"",
                                      "take the model out of it first")
                            .value());
  }
  const auto made = make_robot(options.model, name);
  if (!made) return console.fail(made.error());
  for (const std::string& line : made->summary) {
    const std::size_t colon = line.find(": ");
    console.line(line.substr(0, colon), line.substr(colon + 2));
  }
  for (const std::string& note : made->notes) console.warn({{0, 0, note}}, options.model);
  const auto folder = save_robot(*made, options.output, options.force);
  if (!folder) return console.fail(folder.error());
  console.line("wrote", folder->string() + "; decisions.md says what was decided");
  return kDone;
}

}  // namespace

ExitCode robots(const RobotsOptions& options, Console& console) {
  if (options.action == RobotsAction::kAdd) return add(options, console);
  if (options.action == RobotsAction::kCheck) return check(options, console);
  const auto text = options.action == RobotsAction::kList ? list(options) : show(options);
  if (!text) return console.fail(text.error());
  const auto written = write_file("-", *text);
  return written ? kDone : console.fail(written.error());
}

}  // namespace retarget::cli
