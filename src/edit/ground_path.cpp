#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "retarget/edit.h"
#include "retarget/file.h"
#include "retarget/ground_path.h"
#include "retarget/json.h"
#include "retarget/option_name.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Subdivisions of a segment whose arc lengths are stored.
constexpr int kParts = 16;
// Distance from a cusp, as a fraction of a segment, at which the tangent is evaluated instead.
constexpr double kBesideCusp = 1e-4;

// Five-point Gauss-Legendre quadrature on [-1, 1].
constexpr std::array<std::pair<double, double>, 5> kGauss = {
    {{-0.9061798459386640, 0.2369268850561891},
     {-0.5384693101056831, 0.4786286704993665},
     {0.0, 0.5688888888888889},
     {0.5384693101056831, 0.4786286704993665},
     {0.9061798459386640, 0.2369268850561891}}};

double heading_of(const Eigen::Vector2d& direction) {
  return portable::atan2(direction.y(), direction.x());
}

// Reads and writes paths over the ground as JSON.

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

// Predefined paths, paths through points, and the choice of a path to follow.

// An eighth of a turn; a cubic approximates such an arc to 4e-6 of its radius.
constexpr double kMaxArc = std::numbers::pi / 4.0;

// Appends an arc that begins at the last point; returns its end.
GroundPose add_arc(std::vector<Eigen::Vector2d>& points, const GroundPose& start, double radius,
                   double length) {
  const double turn = length / radius;
  const int arcs = std::max(1, static_cast<int>(std::ceil(std::abs(turn) / kMaxArc - 1e-9)));
  const double angle = turn / arcs;
  const auto [sine, cosine] = portable::sin_cos(angle);
  const auto [quarter_sine, quarter_cosine] = portable::sin_cos(0.25 * angle);
  const double handle = 4.0 / 3.0 * quarter_sine / quarter_cosine * radius;
  // End of one arc, along and to the left of the tangent.
  const GroundPose arc{{radius * sine, radius * (1.0 - cosine)}, angle};
  GroundPose reached = start;
  for (int i = 0; i < arcs; ++i) {
    points.push_back(reached * Eigen::Vector2d(handle, 0.0));
    points.push_back(reached * (arc * Eigen::Vector2d(-handle, 0.0)));
    reached = reached * arc;
    points.push_back(reached.position);
  }
  return reached;
}

}  // namespace

GroundPath::GroundPath(std::vector<Eigen::Vector2d> control_points)
    : points_(std::move(control_points)), lengths_{0.0} {
  assert(points_.size() >= 4 && points_.size() % 3 == 1);
  for (std::size_t segment = 0; segment < segment_count(); ++segment) {
    for (int part = 0; part < kParts; ++part) {
      const double from = static_cast<double>(part) / kParts;
      const double to = static_cast<double>(part + 1) / kParts;
      lengths_.push_back(lengths_.back() + length_between(segment, from, to));
    }
  }
}

Eigen::Vector2d GroundPath::point(std::size_t segment, double u) const {
  const Eigen::Vector2d* p = &points_[3 * segment];
  const double v = 1.0 - u;
  return v * v * v * p[0] + 3.0 * v * v * u * p[1] + 3.0 * v * u * u * p[2] + u * u * u * p[3];
}

Eigen::Vector2d GroundPath::derivative(std::size_t segment, double u) const {
  const Eigen::Vector2d* p = &points_[3 * segment];
  const double v = 1.0 - u;
  return 3.0 * (v * v * (p[1] - p[0]) + 2.0 * v * u * (p[2] - p[1]) + u * u * (p[3] - p[2]));
}

Eigen::Vector2d GroundPath::direction(std::size_t segment, double u) const {
  const Eigen::Vector2d* p = &points_[3 * segment];
  const double size = (p[1] - p[0]).norm() + (p[2] - p[1]).norm() + (p[3] - p[2]).norm();
  constexpr double kVanishes = 1e-9;
  Eigen::Vector2d result = derivative(segment, u);
  if (result.norm() <= kVanishes * size) {
    result = derivative(segment, u < 0.5 ? u + kBesideCusp : u - kBesideCusp);
  }
  return result;
}

double GroundPath::length_between(std::size_t segment, double from, double to) const {
  const double half = 0.5 * (to - from), middle = 0.5 * (to + from);
  double sum = 0.0;
  for (const auto& [node, weight] : kGauss) {
    sum += weight * derivative(segment, middle + half * node).norm();
  }
  return half * sum;
}

double GroundPath::length_to(std::size_t segment, double u) const {
  const int part = std::clamp(static_cast<int>(u * kParts), 0, kParts - 1);
  return lengths_[segment * kParts + static_cast<std::size_t>(part)] +
         length_between(segment, static_cast<double>(part) / kParts, u);
}

GroundPose GroundPath::straight_on(std::size_t segment, double u, double beyond) const {
  const Eigen::Vector2d tangent = direction(segment, u);
  const Eigen::Vector2d place = point(segment, u);
  if (tangent.isZero(0.0)) return {place, 0.0};
  return {place + beyond * tangent.normalized(), heading_of(tangent)};
}

GroundPose GroundPath::at(double along) const {
  // Find the part around the length; parts of zero length are skipped.
  const auto after = std::ranges::upper_bound(lengths_, std::max(along, 0.0));
  if (after == lengths_.end()) {
    // Extrapolate from the last part with nonzero length.
    const auto end = std::ranges::lower_bound(lengths_, length());
    const auto part =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(end - lengths_.begin() - 1, 0));
    const std::size_t segment = part / kParts;
    const double u = static_cast<double>(part % kParts + 1) / kParts;
    return straight_on(segment, u, along - length());
  }
  const auto part = static_cast<std::size_t>(after - lengths_.begin() - 1);
  const std::size_t segment = part / kParts;
  const double begin = static_cast<double>(part % kParts) / kParts;
  if (along <= 0.0) return straight_on(segment, begin, along);

  // Newton's method, safeguarded by bisection within the part.
  const double wanted = along - lengths_[part];
  double low = begin, high = begin + 1.0 / kParts;
  double u = begin + wanted / (*after - lengths_[part]) / kParts;
  constexpr double kClose = 1e-15;
  for (int round = 0; round < 40; ++round) {
    const double miss = length_between(segment, begin, u) - wanted;
    (miss > 0.0 ? high : low) = u;
    const double speed = derivative(segment, u).norm();
    double next = speed > 0.0 ? u - miss / speed : 0.5 * (low + high);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool close = std::abs(next - u) <= kClose;
    u = next;
    if (close) break;
  }
  return straight_on(segment, u, 0.0);
}

GroundPath GroundPath::moved(const GroundPose& move) const {
  std::vector<Eigen::Vector2d> points;
  points.reserve(points_.size());
  for (const Eigen::Vector2d& point : points_) points.push_back(move * point);
  return GroundPath(std::move(points));
}

GroundPath GroundPath::scaled(double scale) const {
  std::vector<Eigen::Vector2d> points;
  points.reserve(points_.size());
  for (const Eigen::Vector2d& point : points_) {
    points.push_back(points_.front() + scale * (point - points_.front()));
  }
  return GroundPath(std::move(points));
}

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

GroundPath line_path(const GroundPose& start, double length) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(4);
  for (int i = 0; i < 4; ++i) points.push_back(start * Eigen::Vector2d(length * i / 3.0, 0.0));
  return GroundPath(std::move(points));
}

GroundPath circle_path(const GroundPose& start, double radius, double length) {
  std::vector<Eigen::Vector2d> points{start.position};
  add_arc(points, start, radius, length);
  return GroundPath(std::move(points));
}

GroundPath figure8_path(const GroundPose& start, double length) {
  const double radius = length / (4.0 * std::numbers::pi);
  if (!(radius > 0.0)) return line_path(start, length);
  std::vector<Eigen::Vector2d> points{start.position};
  const GroundPose middle = add_arc(points, start, radius, 0.5 * length);
  add_arc(points, middle, -radius, 0.5 * length);
  return GroundPath(std::move(points));
}

GroundPath path_through(const std::vector<Eigen::Vector2d>& points) {
  constexpr double kCoincide = 1e-9;
  std::vector<Eigen::Vector2d> places;
  for (const Eigen::Vector2d& point : points) {
    if (places.empty() || (point - places.back()).norm() > kCoincide) places.push_back(point);
  }
  if (places.size() == 1) return line_path({places.front(), 0.0}, 0.0);

  const auto last = places.size() - 1;
  const auto tangent = [&](std::size_t i) -> Eigen::Vector2d {
    const Eigen::Vector2d across = places[std::min(i + 1, last)] - places[i == 0 ? 0 : i - 1];
    // The tangent is zero at a point where the path turns back.
    return across.norm() > kCoincide ? across.normalized() : Eigen::Vector2d(0.0, 0.0);
  };
  std::vector<Eigen::Vector2d> control{places.front()};
  for (std::size_t i = 0; i < last; ++i) {
    const double third = (places[i + 1] - places[i]).norm() / 3.0;
    control.push_back(places[i] + third * tangent(i));
    control.push_back(places[i + 1] - third * tangent(i + 1));
    control.push_back(places[i + 1]);
  }
  return GroundPath(std::move(control));
}

Result<void> PathChange::check() const {
  constexpr double kMinRadius = 0.01;
  if (std::abs(radius) >= kMinRadius) return {};
  return usage_failure(RETARGET_OPTION("radius") " must be at least 0.01 m");
}

Result<GroundPath> change_path(const GroundPath& own, const PathChange& change) {
  RETARGET_TRY(change.check());
  const GroundPose start = own.at(0.0);
  const auto shaped = [&]() -> Result<GroundPath> {
    if (change.to.empty()) return own;
    if (change.to == "line") return line_path(start, own.length());
    if (change.to == "circle") return circle_path(start, change.radius, own.length());
    if (change.to == "figure8") return figure8_path(start, own.length());
    return load_path(change.to);
  };
  RETARGET_TRY_ASSIGN(const GroundPath path, shaped());
  const double angle = change.degrees / 180.0 * std::numbers::pi;
  return path.scaled(change.scale).moved(turn_about(path.control_points().front(), angle));
}

}  // namespace retarget
