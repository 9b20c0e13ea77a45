// Predefined paths, paths through points, and the choice of a path to follow.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/option_name.h"
#include "retarget/trigonometry.h"
#include "retarget/try.h"

namespace retarget {
namespace {

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
