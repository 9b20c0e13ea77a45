#include "scene/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr int kLeafSize = 4;
constexpr double kFourPi = 12.566370614359172954;
// Triangles farther away than this many radii count as a dipole.
constexpr double kFar = 2.5;

// The nearest point of a segment; a segment without length is a point.
Vector3d nearest_on_segment(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double square = along.squaredNorm();
  if (!(square > 0.0)) return a;
  return a + std::clamp((point - a).dot(along) / square, 0.0, 1.0) * along;
}

// Solid angle of a triangle (van Oosterom and Strackee 1983), steradians.
double solid_angle(const Vector3d& point, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d u = a - point, v = b - point, w = c - point;
  const double lu = u.norm(), lv = v.norm(), lw = w.norm();
  const double volume = u.dot(v.cross(w));
  const double rest = lu * lv * lw + u.dot(v) * lw + v.dot(w) * lu + w.dot(u) * lv;
  return volume == 0.0 ? 0.0 : 2.0 * portable::atan2(volume, rest);
}

}  // namespace

// Real-Time Collision Detection (Ericson 2005), section 5.1.5; triangles without area are segments.
Vector3d nearest_on_triangle(const Vector3d& point, const Vector3d& a, const Vector3d& b,
                             const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = point - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vector3d bp = point - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return nearest_on_segment(point, a, b);
  const Vector3d cp = point - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return nearest_on_segment(point, a, c);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return nearest_on_segment(point, b, c);
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return nearest_on_segment(point, a, b);
  return a + vb / sum * ab + vc / sum * ac;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  std::vector<Triangle> triangles;
  std::vector<Vector3d> centres;
  triangles.reserve(mesh.triangles.size());
  centres.reserve(mesh.triangles.size());
  const auto corner = [&](int index) { return mesh.vertices[static_cast<std::size_t>(index)]; };
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({corner(a), corner(b), corner(c)});
    centres.emplace_back((corner(a) + corner(b) + corner(c)) / 3.0);
  }
  std::vector<int> order(triangles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  triangles_.reserve(triangles.size());
  nodes_.reserve(triangles.size());
  build(order, 0, static_cast<int>(order.size()), triangles, centres);
}

int TriangleTree::build(std::vector<int>& order, int begin, int end,
                        const std::vector<Triangle>& triangles,
                        const std::vector<Vector3d>& centres) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  if (end - begin <= kLeafSize) {
    // The order within the range depends on the library.
    std::sort(order.begin() + begin, order.begin() + end);
    for (int i = begin; i < end; ++i) {
      triangles_.push_back(triangles[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])]);
    }
  } else {
    Eigen::AlignedBox3d spread;
    const auto centre = [&](int triangle) -> const Vector3d& {
      return centres[static_cast<std::size_t>(triangle)];
    };
    for (int i = begin; i < end; ++i) spread.extend(centre(order[static_cast<std::size_t>(i)]));
    Eigen::Index axis = 0;
    spread.sizes().maxCoeff(&axis);
    const int middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                     [&](int a, int b) {
                       return std::pair(centre(a)[axis], a) < std::pair(centre(b)[axis], b);
                     });
    build(order, begin, middle, triangles, centres);
    nodes_[static_cast<std::size_t>(index)].right = build(order, middle, end, triangles, centres);
  }
  Node& node = nodes_[static_cast<std::size_t>(index)];
  node.begin = begin;
  node.end = end;
  summarise(node);
  return index;
}

void TriangleTree::summarise(Node& node) const {
  double whole = 0.0;
  Vector3d weighted = Vector3d::Zero();
  for (int i = node.begin; i < node.end; ++i) {
    const auto& [a, b, c] = triangles_[static_cast<std::size_t>(i)];
    for (const Vector3d& corner : {a, b, c}) node.box.extend(corner);
    const Vector3d area = 0.5 * (b - a).cross(c - a);
    const double size = area.norm();
    node.area += area;
    weighted += size * (a + b + c) / 3.0;
    whole += size;
  }
  node.centre = whole > 0.0 ? Vector3d(weighted / whole) : node.box.center();
  for (int i = node.begin; i < node.end; ++i) {
    const auto& [a, b, c] = triangles_[static_cast<std::size_t>(i)];
    for (const Vector3d& corner : {a, b, c}) {
      node.radius = std::max(node.radius, (corner - node.centre).norm());
    }
  }
}

TriangleTree::Nearest TriangleTree::nearest(const Vector3d& point, int guess) const {
  Nearest best{std::numeric_limits<double>::infinity(), -1};
  const auto consider = [&](int index) {
    const auto& [a, b, c] = triangles_[static_cast<std::size_t>(index)];
    const double square = (nearest_on_triangle(point, a, b, c) - point).squaredNorm();
    if (square < best.squared_distance) best = {square, index};
  };
  if (guess >= 0) consider(guess);
  // Halving reaches a leaf in fewer than 32 steps, and each step leaves one child for later.
  std::array<std::pair<double, int>, 64> open;
  std::size_t count = 0;
  open[count++] = {nodes_[0].box.squaredExteriorDistance(point), 0};
  while (count > 0) {
    const auto [bound, index] = open[--count];
    if (bound >= best.squared_distance) continue;
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.right < 0) {
      for (int i = node.begin; i < node.end; ++i) consider(i);
      continue;
    }
    const auto child = [&](int at) {
      return std::pair(nodes_[static_cast<std::size_t>(at)].box.squaredExteriorDistance(point), at);
    };
    auto near = child(index + 1), far = child(node.right);
    if (far.first < near.first) std::swap(near, far);
    open[count++] = far;
    open[count++] = near;
  }
  return best;
}

double TriangleTree::winding_number(const Vector3d& point) const {
  double angle = 0.0;
  std::array<int, 64> open{};
  std::size_t count = 0;
  open[count++] = 0;
  while (count > 0) {
    const int index = open[--count];
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    const Vector3d offset = node.centre - point;
    const double square = offset.squaredNorm();
    if (square > kFar * kFar * node.radius * node.radius && square > 0.0) {
      angle += node.area.dot(offset) / (square * std::sqrt(square));
    } else if (node.right < 0) {
      for (int i = node.begin; i < node.end; ++i) {
        const auto& [a, b, c] = triangles_[static_cast<std::size_t>(i)];
        angle += solid_angle(point, a, b, c);
      }
    } else {
      open[count++] = node.right;
      open[count++] = index + 1;
    }
  }
  return angle / kFourPi;
}

double TriangleTree::exact_winding_number(const Vector3d& point) const {
  double angle = 0.0;
  for (const auto& [a, b, c] : triangles_) angle += solid_angle(point, a, b, c);
  return angle / kFourPi;
}

}  // namespace retarget
