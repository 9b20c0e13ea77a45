#include "robot/anatomy/shapes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <utility>

#include "retarget/so3.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

// Fraction of the points that a capsule encloses; screws and edges may stick out.
constexpr double kInside = 0.98;

struct Capsule {
  Vector3d centre = Vector3d::Zero(), axis = Vector3d::UnitZ();
  double radius = 0.0, half_length = 0.0;

  [[nodiscard]] double volume() const {
    return std::numbers::pi * radius * radius * (2.0 * half_length + 4.0 / 3.0 * radius);
  }
};

// Returns the approximate centre of the smallest enclosing ball (Badoiu and Clarkson).
Vector3d middle_of(const Points& points) {
  constexpr int kSteps = 40;
  Vector3d centre = points.front();
  for (int step = 1; step <= kSteps; ++step) {
    const auto farthest = std::ranges::max_element(
        points, {}, [&](const Vector3d& point) { return (point - centre).squaredNorm(); });
    centre += (*farthest - centre) / (step + 1.0);
  }
  return centre;
}

// Returns the capsule along an axis that encloses the points except the outermost ones.
Capsule capsule_along(const Points& points, const Vector3d& axis) {
  Points across;
  for (const Vector3d& point : points) across.push_back(point - point.dot(axis) * axis);
  Capsule capsule;
  capsule.axis = axis;
  const Vector3d line = middle_of(across);
  std::vector<double> distances;
  for (const Vector3d& point : across) distances.push_back((point - line).norm());
  std::vector<double> sorted = distances;
  const auto last = sorted.begin() +
                    static_cast<std::ptrdiff_t>(kInside * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), last, sorted.end());
  capsule.radius = std::max(*last, 1e-3);
  // The caps are round, so a point near the axis may lie farther out than one at the rim.
  double lower = INFINITY, upper = -INFINITY;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double inside = std::min(distances[i], capsule.radius);
    const double cap = std::sqrt(capsule.radius * capsule.radius - inside * inside);
    lower = std::min(lower, points[i].dot(axis) + cap);
    upper = std::max(upper, points[i].dot(axis) - cap);
  }
  capsule.half_length = std::max(0.5 * (upper - lower), 0.0);
  capsule.centre = line + 0.5 * (upper + lower) * axis;
  return capsule;
}

Eigen::Matrix3d principal_axes(const Points& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& point : points) spread += (point - mean) * (point - mean).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
}

// Returns the capsule along the best of the principal axes.
Capsule small_capsule(const Points& points) {
  const Eigen::Matrix3d axes = principal_axes(points);
  Capsule best = capsule_along(points, axes.col(2));
  for (const int i : {1, 0}) {
    const Capsule other = capsule_along(points, axes.col(i));
    if (other.volume() < best.volume()) best = other;
  }
  return best;
}

// Tilts the axis of the best capsule while its volume decreases.
Capsule smallest_capsule(const Points& points) {
  Capsule best = small_capsule(points);
  for (double tilt = 0.2; tilt > 0.01; tilt *= 0.5) {
    const Vector3d side = best.axis.unitOrthogonal();
    const Vector3d other_side = best.axis.cross(side);
    for (const Vector3d& way : {side, other_side, Vector3d(-side), Vector3d(-other_side)}) {
      const Capsule tilted = capsule_along(points, (best.axis + tilt * way).normalized());
      if (tilted.volume() < best.volume()) best = tilted;
    }
  }
  return best;
}

struct Part {
  Points points;
  Capsule capsule;
};

Part part_of(Points points) {
  const Capsule capsule = smallest_capsule(points);
  return {std::move(points), capsule};
}

// Splits at several positions along each principal axis; returns the parts whose capsules have the
// smallest total volume.
std::array<Part, 2> split(const Part& whole) {
  constexpr std::array kShares = {0.3, 0.5, 0.7};
  constexpr std::size_t kFew = 8;
  std::array<Points, 2> best;
  double least = INFINITY;
  const Eigen::Matrix3d axes = principal_axes(whole.points);
  for (int i = 0; i < 3; ++i) {
    const Vector3d axis = axes.col(i);
    std::vector<double> along;
    for (const Vector3d& point : whole.points) along.push_back(point.dot(axis));
    const auto [lowest, highest] = std::ranges::minmax(along);
    for (const double share : kShares) {
      const double border = lowest + share * (highest - lowest);
      Points below, above;
      for (const Vector3d& point : whole.points) {
        (point.dot(axis) < border ? below : above).push_back(point);
      }
      if (below.size() < kFew || above.size() < kFew) continue;
      const double sum = small_capsule(below).volume() + small_capsule(above).volume();
      if (sum >= least) continue;
      least = sum;
      best = {std::move(below), std::move(above)};
    }
  }
  if (best[0].empty()) return {};
  return {part_of(std::move(best[0])), part_of(std::move(best[1]))};
}

}  // namespace

double diagonal_of(const std::vector<Vector3d>& points) {
  Eigen::AlignedBox3d around;
  for (const Vector3d& point : points) around.extend(point);
  return around.diagonal().norm();
}

CollisionShape box_around(int body, const std::vector<Vector3d>& points,
                          const Eigen::Matrix3d& axes) {
  Eigen::AlignedBox3d around;
  for (const Vector3d& point : points) around.extend(axes.transpose() * point);
  CollisionShape box;
  box.type = CollisionShape::Type::kBox;
  box.body = body;
  box.half_size = 0.5 * around.sizes().cwiseMax(2e-3);
  box.body_from_shape = {Eigen::Quaterniond(axes), axes * around.center()};
  return box;
}

std::vector<Vector3d> thinned(const std::vector<Vector3d>& points, double cell) {
  std::set<std::array<std::int64_t, 3>> taken;
  std::vector<Vector3d> kept;
  for (const Vector3d& point : points) {
    std::array<std::int64_t, 3> key{};
    for (std::size_t i = 0; i < 3; ++i) {
      key[i] = std::llround(point[static_cast<Eigen::Index>(i)] / cell);
    }
    if (taken.insert(key).second) kept.push_back(point);
  }
  return kept;
}

std::vector<CollisionShape> capsules_around(int body, const std::vector<Vector3d>& points) {
  constexpr std::size_t kMost = 3;
  constexpr double kWorthIt = 0.75;  // Fraction of the previous volume.
  std::vector<Part> parts = {part_of(points)};
  while (parts.size() < kMost) {
    const auto largest =
        std::ranges::max_element(parts, {}, [](const Part& part) { return part.capsule.volume(); });
    double before = 0.0;
    for (const Part& part : parts) before += part.capsule.volume();
    std::array<Part, 2> halves = split(*largest);
    const double after = before - largest->capsule.volume() + halves[0].capsule.volume() +
                         halves[1].capsule.volume();
    if (halves[0].points.empty() || after > kWorthIt * before) break;
    *largest = std::move(halves[0]);
    parts.push_back(std::move(halves[1]));
  }
  std::vector<CollisionShape> shapes;
  for (const Part& part : parts) {
    CollisionShape shape;
    shape.type = part.capsule.half_length > 0.0 ? CollisionShape::Type::kCapsule
                                                : CollisionShape::Type::kSphere;
    shape.body = body;
    shape.radius = part.capsule.radius;
    shape.half_length = part.capsule.half_length;
    shape.body_from_shape = {rotation_between(Vector3d::UnitZ(), part.capsule.axis).normalized(),
                             part.capsule.centre};
    shapes.push_back(shape);
  }
  return shapes;
}

double volume(const CollisionShape& shape) {
  if (shape.type == CollisionShape::Type::kBox) return 8.0 * shape.half_size.prod();
  return std::numbers::pi * shape.radius * shape.radius *
         (2.0 * shape.half_length + 4.0 / 3.0 * shape.radius);
}

}  // namespace retarget
