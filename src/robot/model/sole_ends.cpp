#include "robot/model/sole_ends.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace retarget {
namespace {

constexpr double kNoWidth = 1e-3;  // Metres: narrower corners define no plane.
constexpr double kBeside = 1e-3;  // Metres: an origin closer than this to the middle line counts as
                                  // above it.

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& points) {
  const Eigen::Vector3d sum =
      std::accumulate(points.begin(), points.end(), Eigen::Vector3d(0.0, 0.0, 0.0));
  return sum / static_cast<double>(points.size());
}

// Assigns each point to an end; -1: neither.
std::vector<int> ends_of_points(const Sole& sole) {
  std::vector<int> ends;
  if (sole.labels.size() == sole.points.size()) {
    for (const std::string& label : sole.labels) {
      const bool heel = label.starts_with("heel"), toe = label.starts_with("toe");
      ends.push_back(heel ? kSoleHeel : toe ? kSoleToe : -1);
    }
    if (std::ranges::count(ends, kSoleHeel) > 0 && std::ranges::count(ends, kSoleToe) > 0)
      return ends;
  }
  ends.assign(sole.points.size(), kSoleHeel);
  double longest = 0.0;
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  for (const auto& a : sole.points) {
    for (const auto& b : sole.points) {
      if ((b - a).norm() <= longest) continue;
      longest = (b - a).norm();
      from = a.norm() <= b.norm() ? a : b;
      to = a.norm() <= b.norm() ? b : a;
    }
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if ((sole.points[i] - 0.5 * (from + to)).dot(to - from) > 0.0) ends[i] = kSoleToe;
  }
  return ends;
}

// Returns the perpendicular vector from the middle line to the farthest corner.
Eigen::Vector3d across_sole(const std::array<std::vector<Eigen::Vector3d>, 2>& corners,
                            const SoleShape& shape, const Eigen::Vector3d& forward) {
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  for (std::size_t end = 0; end < 2; ++end) {
    for (const Eigen::Vector3d& corner : corners[end]) {
      const Eigen::Vector3d out = corner - shape.ends[end].middle;
      const Eigen::Vector3d square = out - forward * forward.dot(out);
      if (square.norm() > across.norm()) across = square;
    }
  }
  return across;
}

}  // namespace

std::optional<SoleShape> sole_shape(const Sole& sole) {
  if (sole.points.size() < 2) return std::nullopt;
  SoleShape shape;
  std::array<std::vector<Eigen::Vector3d>, 2> corners;
  const std::vector<int> ends = ends_of_points(sole);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if (ends[i] < 0) continue;
    const auto end = static_cast<std::size_t>(ends[i]);
    shape.ends[end].points.push_back(sole.points[i]);
    const bool tip = i < sole.labels.size() && sole.labels[i].ends_with("_tip");
    if (!tip) corners[end].push_back(sole.points[i]);
  }
  for (std::size_t end = 0; end < 2; ++end) {
    if (shape.ends[end].points.empty()) return std::nullopt;
    if (corners[end].empty()) corners[end] = shape.ends[end].points;
    shape.ends[end].middle = mean_of(corners[end]);
  }
  const Eigen::Vector3d heel = shape.ends[kSoleHeel].middle;
  const Eigen::Vector3d forward = (shape.ends[kSoleToe].middle - heel).normalized();
  // Up is perpendicular to the plane of the corners, towards the body's origin.
  const Eigen::Vector3d to_origin = forward * forward.dot(heel) - heel;
  const Eigen::Vector3d across = across_sole(corners, shape, forward);
  Eigen::Vector3d above = to_origin;
  shape.body_height = to_origin.norm();
  if (across.norm() > kNoWidth) {
    const Eigen::Vector3d normal = forward.cross(across).normalized();
    const double height = normal.dot(to_origin);
    if ((to_origin - normal * height).norm() > kBeside) {
      above = height < 0.0 ? Eigen::Vector3d(-normal) : normal;
      shape.body_height = std::abs(height);
    }
  }
  shape.sideways = above.cross(forward).normalized();
  for (std::size_t end = 0; end < 2; ++end) {
    SolePoints& of_end = shape.ends[end];
    const Eigen::Vector3d outwards = end == kSoleToe ? forward : Eigen::Vector3d(-forward);
    double reach = 0.0;
    for (const auto& point : of_end.points) {
      reach = std::max(reach, outwards.dot(point - of_end.middle));
    }
    of_end.tip = of_end.middle + reach * outwards;
    for (const auto& corner : corners[end]) {
      of_end.half_width =
          std::max(of_end.half_width, std::abs(shape.sideways.dot(corner - of_end.middle)));
    }
  }
  return shape;
}

}  // namespace retarget
