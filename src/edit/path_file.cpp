// Reads and writes paths over the ground as JSON.

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/file.h"
#include "retarget/ground_path.h"
#include "retarget/json.h"
#include "retarget/option_name.h"
#include "retarget/try.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kHint =
    "a path must be {\"control_points\": [[x, y], ...]} with 3n + 1 points in metres, or "
    "{\"waypoints\": [[x, y], ...]}; retarget edit path IN " RETARGET_OPTION(
        "fit") " FILE writes a path file";

// Metres: larger than any stage.
constexpr double kMaxCoordinate = 1e6;

std::optional<Eigen::Vector2d> point_from(const Json& json) {
  if (!json.is_array() || json.size() != 2) return std::nullopt;
  Eigen::Vector2d point;
  for (int axis = 0; axis < 2; ++axis) {
    if (!json[static_cast<std::size_t>(axis)].is_number()) return std::nullopt;
    point[axis] = json[static_cast<std::size_t>(axis)].get<double>();
    if (!(std::abs(point[axis]) <= kMaxCoordinate)) return std::nullopt;
  }
  return point;
}

}  // namespace

Result<GroundPath> parse_path(std::string_view text, const std::string& file) {
  RETARGET_TRY_ASSIGN(const auto json, parse_json(text, file));
  const bool controls = json.is_object() && json.contains("control_points");
  const bool waypoints = json.is_object() && json.contains("waypoints");
  if (controls == waypoints) {
    return config_failure(file,
                          controls ? "has both \"control_points\" and \"waypoints\""
                                   : "has neither \"control_points\" nor \"waypoints\"",
                          kHint);
  }
  const std::string name = controls ? "control_points" : "waypoints";
  const Json& list = json[name];
  if (!list.is_array()) {
    return config_failure(
        file, "\"" + name + "\" must be a list of points, found " + short_text(list), kHint);
  }
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto point = point_from(list[i]);
    if (!point) {
      return config_failure(file,
                            "point " + std::to_string(i) + " of \"" + name +
                                "\" must be [x, y] in metres, found " + short_text(list[i]),
                            kHint);
    }
    points.push_back(*point);
  }
  if (points.empty() || (controls && (points.size() < 4 || points.size() % 3 != 1))) {
    return config_failure(file,
                          "\"" + name + "\" has " + std::to_string(points.size()) + " points" +
                              (controls ? ", not 3n + 1" : ""),
                          kHint);
  }
  return controls ? GroundPath(std::move(points)) : path_through(points);
}

Result<GroundPath> load_path(const std::string& path) {
  RETARGET_TRY_ASSIGN(const auto content, read_file(path, ErrorKind::kConfig, kMaxTextBytes));
  return parse_path(content.view(), path);
}

std::string format_path(const GroundPath& path) {
  std::string text =
      "{\n  \"about\": \"a path over the ground, metres: a chain of cubic Bezier segments\",\n"
      "  \"control_points\": [";
  for (std::size_t i = 0; i < path.control_points().size(); ++i) {
    const Eigen::Vector2d& point = path.control_points()[i];
    text += (i == 0 ? "\n    " : ",\n    ") + Json({point.x(), point.y()}).dump();
  }
  return text + "\n  ]\n}\n";
}

}  // namespace retarget
