// The files of robots by name: for lists, descriptions and checks.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/json.h"
#include "retarget/kinematic_tree.h"
#include "retarget/load_robot.h"
#include "retarget/options.h"
#include "retarget/retargeting_config.h"
#include "retarget/rig.h"
#include "retarget/robot.h"
#include "retarget/robots.h"
#include "retarget/shape_distance.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Adds the configurations next to the model and, for a robot, in the data folder.
RobotSources with_configs(const fs::path& model, const fs::path& profile,
                          const std::string& data_folder) {
  const fs::path named = model.parent_path();
  const fs::path folder = named.empty() ? fs::path(".") : named;
  // The folder of a bare model may have any name, also that of a robot.
  if (profile.empty()) {
    const fs::path own = folder / "ik.json";
    return {{}, model.string(), {}, is_file(own) ? own.string() : std::string(), {}};
  }
  const auto found =
      find_configs({}, Method::kGmr, folder, data_folder, fs::absolute(folder).filename().string());
  const ConfigFiles configs = found.value_or(ConfigFiles{});
  return {{}, model.string(), profile.string(), configs.of_lafan1, configs.of_others};
}

// Describes robots in text and JSON.

using Json = nlohmann::ordered_json;

// Heights in the zero configuration, metres.
struct Heights {
  double sole = 0.0;   // From the soles to the root body's origin.
  double whole = 0.0;  // From the soles to the highest known point.
};

std::optional<Heights> heights_of(const Robot& robot) {
  const TreeState posed(robot.tree(), robot.zero_configuration());
  const double root = posed.origin().z();
  double lowest = INFINITY;
  for (const Sole& sole : robot.profile().soles) {
    for (const Eigen::Vector3d& point : sole.points) {
      lowest = std::min(lowest, (posed.world_from_body(sole.body) * point).z());
    }
  }
  if (!std::isfinite(lowest)) return std::nullopt;
  double highest = root;
  for (int body = 1; body < static_cast<int>(robot.bodies().size()); ++body) {
    highest = std::max(highest, posed.world_from_body(body).translation.z());
  }
  for (const CollisionShape& shape : robot.collision_shapes()) {
    for (const Eigen::Vector3d& point : core_points(shape)) {
      highest = std::max(highest, (posed.world_from_body(shape.body) * point).z() + shape.radius);
    }
  }
  return Heights{root - lowest, highest - lowest};
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json() : Json(text);
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

Json config_json(const RetargetingConfig& config) {
  Json rows = Json::array();
  for (const IkMatch& row : config.match_tables[0].rows) {
    const auto second = std::ranges::find(config.match_tables[1].rows, row.body, &IkMatch::body);
    const bool has_second = second != config.match_tables[1].rows.end();
    const double* scale = config.find_scale(row.bone);
    rows.push_back(
        {{"body", row.body},
         {"bone", row.bone},
         {"scale", scale == nullptr ? Json() : Json(*scale)},
         {"pass1", {row.position_weight, row.rotation_weight}},
         {"pass2", has_second ? Json{second->position_weight, second->rotation_weight} : Json()}});
  }
  return rows;
}

Json robot_json(const Robot& robot, const RobotSources& files) {
  Json json;
  json["name"] = robot.name();
  json["description"] = robot.profile().description;
  json["source"] = robot.profile().source;
  json["licence"] = robot.profile().licence;
  json["revision"] = text_or_null(robot.profile().revision);
  json["revision_date"] = text_or_null(robot.profile().revision_date);
  json["soles_estimated"] = robot.profile().soles_estimated;
  const auto heights = heights_of(robot);
  json["height_m"] = heights ? Json(heights->whole) : Json();
  json["sole_height_m"] = heights ? Json(heights->sole) : Json();
  json["root_body"] = robot.bodies()[robot.root_body()].name;
  json["default_limits"] = robot.limits_for("");
  json["joints"] = joints_json(robot);
  // The published configuration has an effect only with the published method.
  const bool has_published = !files.config_of_others.empty();
  const std::string& file = has_published ? files.config_of_others : files.config;
  json["mapping_file"] = text_or_null(file);
  if (file.empty()) return json;
  const auto config = load_retargeting_config(file);
  json["mapping"] = config ? config_json(*config) : Json();
  if (has_published) json["mapping_file_published"] = files.config;
  return json;
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

std::string recorded(const Json& text) {
  return text.is_null() ? "not recorded" : text.get<std::string>();
}

std::string plain_text(const Json& json) {
  std::string text =
      json["name"].get<std::string>() + ": " + json["description"].get<std::string>();
  text += "\nsource   " + json["source"].get<std::string>() + "\nlicence  " +
          json["licence"].get<std::string>() + "\nrevision " + recorded(json["revision"]) +
          ", date " + recorded(json["revision_date"]) + "\n";
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
  if (json["mapping_file"].is_null()) return text + "\nno retargeting configuration\n";
  text += "\nretargeting configuration  " + json["mapping_file"].get<std::string>() + "\n";
  if (json.contains("mapping_file_published")) {
    text += "  with the method gmr and LAFAN1's skeleton: " +
            json["mapping_file_published"].get<std::string>() + "\n";
  }
  text += padded("body", 32) + padded("bone", 16) + padded("scale", 8) +
          "position and rotation weights, both passes\n";
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

// The row of a robot whose model is not known: not installed, or with an error.
Json row_without_model(const RobotSources& robot) {
  return {{"name", robot.name},
          {"description", robot.description},
          {"joints", nullptr},
          {"height_m", nullptr},
          {"mapping", !robot.config.empty()},
          {"licence", robot.licence},
          {"revision", nullptr},
          {"revision_date", nullptr},
          {"licence_stated", robot.licence_stated},
          {"installed", false},
          {"error", nullptr}};
}

Json broken_row(const RobotSources& robot, const Error& error) {
  Json row = row_without_model(robot);
  row["licence_stated"] = !is_unverified(robot.model);
  row["installed"] = true;
  row["error"] = located_message(error);
  return row;
}

Json installed_row(const Robot& robot, const RobotSources& files) {
  Json row = row_without_model(files);
  const auto heights = heights_of(robot);
  row["description"] = robot.profile().description;
  row["joints"] = robot.output_joints().size();
  if (heights) row["height_m"] = heights->whole;
  row["licence"] = robot.profile().licence;
  row["revision"] = text_or_null(robot.profile().revision);
  row["revision_date"] = text_or_null(robot.profile().revision_date);
  row["licence_stated"] = !is_unverified(files.model);
  row["installed"] = true;
  return row;
}

std::string line_of(const RobotSources& robot, const std::string& joints, const std::string& height,
                    const std::string& remarks) {
  return padded(robot.name, 26) + padded(joints, 12) + padded(height, 8) + remarks + "\n";
}

std::string left_out_line(const RobotSources& robot) {
  return line_of(robot, "-", "-",
                 robot.description + (robot.licence_stated ? "" : " (no stated licence)") +
                     " (not installed)");
}

// The first line of the error; `robots check` prints the others.
std::string broken_line(const RobotSources& robot, Error error) {
  error.details.clear();
  error.hint.clear();
  return line_of(robot, "-", "-", "error: " + located_message(error));
}

std::string installed_line(const Robot& robot, const RobotSources& files) {
  const auto heights = heights_of(robot);
  return line_of(files, count_text(robot.output_joints().size(), "joint"),
                 heights ? number_text(heights->whole, 2) + " m" : "-",
                 robot.profile().description +
                     (files.config.empty() ? " (no retargeting configuration)" : "") +
                     (is_unverified(files.model) ? " (no stated licence)" : ""));
}

}  // namespace

Result<RobotSources> find_robot_sources(const std::string& name_or_folder,
                                        const std::string& data_folder) {
  RETARGET_TRY_ASSIGN(const auto files, find_robot(name_or_folder, robot_folders(data_folder)));
  RobotSources sources = with_configs(files.model, files.profile, data_folder);
  sources.warning = files.warning;
  return sources;
}

RobotSources sources_of_model(const fs::path& model, const std::string& data_folder) {
  const fs::path profile = model.parent_path() / "robot.json";
  return with_configs(model, is_file(profile) ? profile : fs::path(), data_folder);
}

Result<std::vector<RobotSources>> list_robot_sources(const std::string& data_folder) {
  const RobotFolders folders = robot_folders(data_folder);
  const std::vector<std::string> installed = list_robots(folders);
  std::vector<RobotSources> robots;
  for (const std::string& name : installed) {
    RETARGET_TRY_ASSIGN(auto robot, find_robot_sources(name, data_folder));
    robot.name = name;
    robots.push_back(std::move(robot));
  }
  RETARGET_TRY_ASSIGN(const auto known, known_robots(folders));
  for (const KnownRobot& robot : known) {
    if (std::ranges::find(installed, robot.name) != installed.end()) continue;
    RobotSources left_out;
    left_out.name = robot.name;
    left_out.description = robot.description;
    left_out.licence = robot.licence;
    left_out.licence_stated = robot.in_packages;
    robots.push_back(std::move(left_out));
  }
  std::ranges::sort(robots, {}, &RobotSources::name);
  return robots;
}

Result<std::string> describe_robot(const RobotSources& robot, TextForm form) {
  RETARGET_TRY_ASSIGN(const auto loaded, load_robot_files(robot.model, robot.profile));
  const Json json = robot_json(*loaded, robot);
  return form == TextForm::kJson ? printable_dump(json) : printable(plain_text(json));
}

Result<std::string> describe_robots(std::span<const RobotSources> robots, TextForm form) {
  Json all = Json::array();
  std::string text;
  for (const RobotSources& each : robots) {
    if (each.model.empty()) {
      all.push_back(row_without_model(each));
      text += left_out_line(each);
      continue;
    }
    const auto robot = load_robot_files(each.model, each.profile);
    all.push_back(robot ? installed_row(**robot, each) : broken_row(each, robot.error()));
    text += robot ? installed_line(**robot, each) : broken_line(each, robot.error());
  }
  return form == TextForm::kJson ? printable_dump(all) : printable(text);
}

}  // namespace retarget
