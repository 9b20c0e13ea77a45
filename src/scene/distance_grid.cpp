#include "scene/distance_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <system_error>

#include "base/sha256.h"
#include "retarget/bytes.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kCells = 72.0;                        // Along the longest side.
constexpr double kMaxSpacing = 0.02;                   // Metres, unless the grid becomes too large.
constexpr double kCoarsest = 0.25;                     // Metres.
constexpr double kGridMargin = 0.08;                   // Metres.
constexpr double kMinMargin = 4.0, kMaxMargin = 16.0;  // Cells.
constexpr double kMaxNodes = 2e6;
constexpr double kMaxNodesOfAxis = 1e6;  // Limit per axis, checked before the product of all axes.
constexpr double kSmallest = 1e-6;       // Metres; the size of a mesh that is a single point.

// Cubic Hermite polynomials: weights of the values and slopes at both ends of a cell, at a position
// in it, and the derivatives of these weights.
struct Hermite {
  double value0, value1, slope0, slope1;
};
struct Weights {
  Hermite at, rate;
};

Weights weights_at(double t) {
  const double t2 = t * t, t3 = t2 * t;
  const double rise = 3.0 * t2 - 2.0 * t3, rise_rate = 6.0 * (t - t2);
  return {{1.0 - rise, rise, t3 - 2.0 * t2 + t, t3 - t2},
          {-rise_rate, rise_rate, 3.0 * t2 - 4.0 * t + 1.0, 3.0 * t2 - 2.0 * t}};
}

double combined(const Hermite& w, double value0, double value1, double slope0, double slope1) {
  return w.value0 * value0 + w.value1 * value1 + w.slope0 * slope0 + w.slope1 * slope1;
}

double combined(const Hermite& w, double value0, double value1) {
  return w.value0 * value0 + w.value1 * value1;
}

// Values along an edge of a cell in x, and on a face in x and y: the function, its derivatives, and
// its slopes in the other axes, per cell.
struct OnEdge {
  double value, by_x, slope_y, slope_y_by_x, slope_z, slope_z_by_x;
};
struct OnFace {
  double value, by_x, by_y, slope_z, slope_z_by_x, slope_z_by_y;
};

// @param node  value and slopes of a node, followed by those of the next one in x.
OnEdge on_edge(const float* node, const Weights& x) {
  return {combined(x.at, node[0], node[4], node[1], node[5]),
          combined(x.rate, node[0], node[4], node[1], node[5]),
          combined(x.at, node[2], node[6]),
          combined(x.rate, node[2], node[6]),
          combined(x.at, node[3], node[7]),
          combined(x.rate, node[3], node[7])};
}

OnFace on_face(const OnEdge& a, const OnEdge& b, const Weights& y) {
  return {combined(y.at, a.value, b.value, a.slope_y, b.slope_y),
          combined(y.at, a.by_x, b.by_x, a.slope_y_by_x, b.slope_y_by_x),
          combined(y.rate, a.value, b.value, a.slope_y, b.slope_y),
          combined(y.at, a.slope_z, b.slope_z),
          combined(y.at, a.slope_z_by_x, b.slope_z_by_x),
          combined(y.rate, a.slope_z, b.slope_z)};
}

}  // namespace

Result<GridLayout> grid_layout(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) box.extend(mesh.vertices[static_cast<std::size_t>(index)]);
  }
  const double longest = std::max(box.sizes().maxCoeff(), kSmallest);
  const auto with_spacing = [&](double spacing) {
    const double margin = std::clamp(std::ceil(kGridMargin / spacing), kMinMargin, kMaxMargin);
    GridLayout layout;
    layout.spacing = spacing;
    layout.origin = box.min() - Vector3d::Constant(margin * spacing);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double cells = std::ceil(box.sizes()[static_cast<Eigen::Index>(axis)] / spacing);
      layout.nodes[axis] = static_cast<int>(std::min(cells + 2.0 * margin + 1.0, kMaxNodesOfAxis));
    }
    return layout;
  };
  constexpr double kStep = 1.1;
  const double first = std::min(longest / kCells, kMaxSpacing);
  for (double spacing = first; spacing <= kCoarsest; spacing *= kStep) {
    const GridLayout layout = with_spacing(spacing);
    if (static_cast<double>(layout.count()) <= kMaxNodes) return layout;
  }
  return input_failure(
      "", "a mesh of " + number_text(longest, 1) + " m is too large for a grid of distances",
      "split it into smaller parts, or check its unit: lengths are metres");
}

DistanceGrid::DistanceGrid(const GridLayout& layout, const std::vector<float>& values)
    : layout_(layout), cells_per_metre_(1.0 / layout.spacing) {
  std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(layout.nodes[0]), 0};
  stride[2] = stride[1] * static_cast<std::size_t>(layout.nodes[1]);
  // Central differences; one-sided ones at the border.
  const auto slope = [&](std::size_t node, int place, std::size_t axis) {
    const std::size_t before = place > 0 ? node - stride[axis] : node;
    const std::size_t after = place + 1 < layout.nodes[axis] ? node + stride[axis] : node;
    const float step = before != node && after != node ? 0.5F : 1.0F;
    return step * (values[after] - values[before]);
  };
  nodes_.reserve(values.size());
  for (int k = 0; k < layout.nodes[2]; ++k) {
    for (int j = 0; j < layout.nodes[1]; ++j) {
      for (int i = 0; i < layout.nodes[0]; ++i) {
        const std::size_t node = nodes_.size();
        nodes_.push_back({values[node], slope(node, i, 0), slope(node, j, 1), slope(node, k, 2)});
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    highest_[i] = layout.origin[i] + (layout.nodes[axis] - 1) * layout.spacing;
  }
}

std::vector<float> DistanceGrid::values() const {
  std::vector<float> values;
  values.reserve(nodes_.size());
  for (const Node& node : nodes_) values.push_back(node.value);
  return values;
}

DistanceGrid::Sample DistanceGrid::interpolate(const Vector3d& point) const {
  const Vector3d place = (point - layout_.origin) * cells_per_metre_;
  std::array<std::size_t, 3> cell{};
  std::array<Weights, 3> weights;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = place[static_cast<Eigen::Index>(axis)];
    const int index = std::clamp(static_cast<int>(at), 0, layout_.nodes[axis] - 2);
    cell[axis] = static_cast<std::size_t>(index);
    weights[axis] = weights_at(at - index);
  }
  const auto row = static_cast<std::size_t>(layout_.nodes[0]);
  const std::size_t layer = row * static_cast<std::size_t>(layout_.nodes[1]);
  const Node* corner = nodes_.data() + cell[2] * layer + cell[1] * row + cell[0];
  const auto face = [&](const Node* node) {
    return on_face(on_edge(&node->value, weights[0]), on_edge(&node[row].value, weights[0]),
                   weights[1]);
  };
  const OnFace a = face(corner), b = face(corner + layer);
  const auto& [at, rate] = weights[2];
  return {combined(at, a.value, b.value, a.slope_z, b.slope_z),
          cells_per_metre_ * Vector3d(combined(at, a.by_x, b.by_x, a.slope_z_by_x, b.slope_z_by_x),
                                      combined(at, a.by_y, b.by_y, a.slope_z_by_y, b.slope_z_by_y),
                                      combined(rate, a.value, b.value, a.slope_z, b.slope_z))};
}

SurfaceDistance DistanceGrid::at(const Vector3d& point) const {
  const Vector3d inside = point.cwiseMax(layout_.origin).cwiseMin(highest_);
  const Sample sample = interpolate(inside);
  const double steepness = sample.gradient.norm();
  const Vector3d normal =
      steepness > 0.0 ? Vector3d(sample.gradient / steepness) : Vector3d::UnitZ();
  if (inside == point) return {sample.value, normal};
  const Vector3d surface = inside - std::max(sample.value, 0.0) * normal;
  const Vector3d offset = point - surface;
  const double distance = offset.norm();
  return {distance, distance > 0.0 ? Vector3d(offset / distance) : normal};
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "RTGRID\r\n";
// Increase this when the samples of the same mesh and layout change.
constexpr std::uint64_t kVersion = 2;
constexpr std::size_t kHashLength = 64;

void append_number(std::string& bytes, double value) {
  append_little_endian(bytes, std::bit_cast<std::uint64_t>(value), 8);
}

std::string head_of(const GridLayout& layout) {
  std::string bytes(kMagic);
  append_little_endian(bytes, kVersion, 4);
  append_number(bytes, layout.spacing);
  for (const double value : layout.origin) append_number(bytes, value);
  for (const int count : layout.nodes) {
    append_little_endian(bytes, static_cast<std::uint64_t>(count), 4);
  }
  return bytes;
}

}  // namespace

std::string grid_file_name(const TriangleMesh& mesh, const GridLayout& layout) {
  std::string content = head_of(layout);
  content.reserve(content.size() + 24 * mesh.vertices.size() + 12 * mesh.triangles.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    for (const double value : vertex) append_number(content, value);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) {
      append_little_endian(content, static_cast<std::uint64_t>(corner), 4);
    }
  }
  return sha256_hex(content) + ".grid";
}

std::optional<DistanceGrid> read_grid(const std::string& file, const GridLayout& layout) {
  if (!is_file(file)) return std::nullopt;
  const std::string head = head_of(layout);
  const std::size_t size = head.size() + 4 * layout.count() + kHashLength;
  const auto content = read_file(file, ErrorKind::kInput, size);
  if (!content || content->view().size() != size) return std::nullopt;
  const std::string_view bytes = content->view();
  if (!bytes.starts_with(head)) return std::nullopt;
  const std::string_view checked = bytes.substr(0, size - kHashLength);
  if (bytes.substr(checked.size()) != sha256_hex(checked)) return std::nullopt;
  ByteReader<std::endian::little> reader(checked.substr(head.size()));
  std::vector<float> values(layout.count());
  for (float& value : values) value = reader.number<float>();
  const auto finite = [](float value) { return std::isfinite(value); };
  if (!std::ranges::all_of(values, finite)) return std::nullopt;
  return DistanceGrid(layout, values);
}

void write_grid(const std::string& file, const DistanceGrid& grid) {
  std::error_code error;
  fs::create_directories(fs::path(file).parent_path(), error);
  if (error) return;
  std::string bytes = head_of(grid.layout());
  bytes.reserve(bytes.size() + 4 * grid.layout().count() + kHashLength);
  for (const float value : grid.values()) append_little_endian(bytes, value);
  bytes += sha256_hex(bytes);
  static_cast<void>(write_file(file, bytes));
}

}  // namespace retarget
