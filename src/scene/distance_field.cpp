#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "base/try.h"
#include "retarget/scene.h"
#include "scene/distance_grid.h"
#include "scene/sample_distance.h"

namespace retarget {
namespace {

// Signed distances to solids in their own frames, metres. Outside they are exact and their normals
// are continuous. Where several surface points are equally near, inside a solid, one rule decides:
// the top before the bottom, z before y before x, and +x for an axis of rotation.

using Eigen::Vector3d;

// Normalises the offset from a centre; a zero offset has no direction.
Vector3d direction_of(const Vector3d& offset, double length, const Vector3d& otherwise) {
  return length > 0.0 ? Vector3d(offset / length) : otherwise;
}

double sign_of(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

// Distance to the half space below z = 0.
SurfaceDistance distance_to_plane(const Vector3d& point) {
  return {point.z(), Vector3d::UnitZ()};
}

// @param half_size  not negative, metres.
SurfaceDistance distance_to_box(const Vector3d& half_size, const Vector3d& point) {
  const Vector3d beyond = point.cwiseAbs() - half_size;
  const Vector3d outside = beyond.cwiseMax(0.0);
  const double distance = outside.norm();
  if (distance > 0.0) {
    Vector3d normal = outside / distance;
    for (int axis = 0; axis < 3; ++axis) normal[axis] *= sign_of(point[axis]);
    return {distance, normal};
  }
  int nearest = 2;
  for (const int axis : {1, 0}) {
    if (beyond[axis] > beyond[nearest]) nearest = axis;
  }
  return {beyond[nearest], sign_of(point[nearest]) * Vector3d::Unit(nearest)};
}

SurfaceDistance distance_to_sphere(double radius, const Vector3d& point) {
  const double length = point.norm();
  return {length - radius, direction_of(point, length, Vector3d::UnitZ())};
}

// @param half_length  half of the distance between the centres of the ends, metres.
SurfaceDistance distance_to_capsule(double radius, double half_length, const Vector3d& point) {
  const double nearest = std::clamp(point.z(), -half_length, half_length);
  const Vector3d offset = point - Vector3d(0.0, 0.0, nearest);
  const double length = offset.norm();
  const bool at_end = std::abs(point.z()) >= half_length;
  const Vector3d otherwise =
      at_end ? Vector3d(sign_of(point.z()) * Vector3d::UnitZ()) : Vector3d::UnitX();
  return {length - radius, direction_of(offset, length, otherwise)};
}

// @param half_length  half of the height along z, metres.
SurfaceDistance distance_to_cylinder(double radius, double half_length, const Vector3d& point) {
  const Vector3d across(point.x(), point.y(), 0.0);
  const double from_axis = across.norm();
  const Vector3d radial = direction_of(across, from_axis, Vector3d::UnitX());
  const Vector3d axial = sign_of(point.z()) * Vector3d::UnitZ();
  const double beyond_side = from_axis - radius;
  const double beyond_end = std::abs(point.z()) - half_length;
  const double side = std::max(beyond_side, 0.0), end = std::max(beyond_end, 0.0);
  const double distance = std::sqrt(side * side + end * end);
  if (distance > 0.0) return {distance, (side * radial + end * axial) / distance};
  return beyond_side > beyond_end ? SurfaceDistance{beyond_side, radial}
                                  : SurfaceDistance{beyond_end, axial};
}

}  // namespace

using Eigen::Matrix3d;
using Type = SceneShape::Type;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A sphere about the shape's origin that encloses it.
double radius_of(const SceneShape& shape) {
  switch (shape.type) {
    case Type::kPlane:
      return kInfinity;
    case Type::kBox:
      return shape.half_size.norm();
    case Type::kSphere:
      return shape.radius;
    case Type::kCapsule:
      return shape.radius + shape.half_length;
    case Type::kCylinder:
      return std::sqrt(shape.radius * shape.radius + shape.half_length * shape.half_length);
    case Type::kMesh:
      break;
  }
  double square = 0.0;
  for (const Vector3d& vertex : shape.mesh->vertices) {
    square = std::max(square, vertex.squaredNorm());
  }
  return std::sqrt(square);
}

// The smallest product of `up` with a point of a shape. @param up  unit length, in the shape's frame
double support_below(const SceneShape& shape, const Vector3d& up) {
  switch (shape.type) {
    case Type::kPlane:
      return -kInfinity;
    case Type::kBox:
      return -up.cwiseAbs().dot(shape.half_size);
    case Type::kSphere:
      return -shape.radius;
    case Type::kCapsule:
      return -shape.radius - std::abs(up.z()) * shape.half_length;
    case Type::kCylinder:
      return -shape.radius * std::sqrt(up.x() * up.x() + up.y() * up.y()) -
             std::abs(up.z()) * shape.half_length;
    case Type::kMesh:
      break;
  }
  double lowest = kInfinity;
  for (const Vector3d& vertex : shape.mesh->vertices) lowest = std::min(lowest, up.dot(vertex));
  return lowest;
}

// Reads the grid of a mesh from the cache, or samples it.
Result<DistanceGrid> grid_of(const TriangleMesh& mesh, const std::string& cache) {
  TRY_ASSIGN(const GridLayout layout, grid_layout(mesh));
  if (cache.empty()) return DistanceGrid(layout, sample_distance(mesh, layout));
  const std::string file = (std::filesystem::path(cache) / grid_file_name(mesh, layout)).string();
  if (auto grid = read_grid(file, layout)) return std::move(*grid);
  DistanceGrid grid(layout, sample_distance(mesh, layout));
  write_grid(file, grid);
  return grid;
}

}  // namespace

// A shape of the body, prepared for queries.
struct DistanceField::Part {
  SceneShape shape;
  Matrix3d body_from_shape;
  double radius = 0.0;  // Of a sphere about the shape's origin.
  std::optional<DistanceGrid> grid;

  [[nodiscard]] SurfaceDistance in_shape(const Vector3d& point) const {
    switch (shape.type) {
      case Type::kPlane:
        return distance_to_plane(point);
      case Type::kBox:
        return distance_to_box(shape.half_size, point);
      case Type::kSphere:
        return distance_to_sphere(shape.radius, point);
      case Type::kCapsule:
        return distance_to_capsule(shape.radius, shape.half_length, point);
      case Type::kCylinder:
        return distance_to_cylinder(shape.radius, shape.half_length, point);
      case Type::kMesh:
        break;
    }
    return grid->at(point);
  }
};

SurfaceDistance DistanceField::at(const Vector3d& in_body) const {
  SurfaceDistance nearest{kInfinity, Vector3d::UnitZ()};
  for (const auto& part : parts_) {
    const Vector3d offset = in_body - part->shape.body_from_shape.translation;
    // The part is farther away than another one, whatever its shape.
    const double far = nearest.distance + part->radius;
    if (far < kInfinity && far > 0.0 && offset.squaredNorm() > far * far) continue;
    const SurfaceDistance found = part->in_shape(part->body_from_shape.transpose() * offset);
    if (!(found.distance < nearest.distance)) continue;
    nearest = {found.distance, part->body_from_shape * found.normal};
  }
  return nearest;
}

double DistanceField::lowest(const Eigen::Quaterniond& world_from_body) const {
  double lowest = kInfinity;
  // The world's up in the body's frame.
  const Vector3d up = world_from_body.conjugate() * Vector3d::UnitZ();
  for (const auto& part : parts_) {
    const Vector3d in_shape = part->body_from_shape.transpose() * up;
    lowest = std::min(lowest, up.dot(part->shape.body_from_shape.translation) +
                                  support_below(part->shape, in_shape));
  }
  return lowest;
}

Result<DistanceField> make_distance_field(const SceneBody& body, const std::string& cache) {
  DistanceField field;
  for (const SceneShape& shape : body.shapes) {
    auto part = std::make_shared<DistanceField::Part>();
    part->shape = shape;
    part->body_from_shape = shape.body_from_shape.rotation.toRotationMatrix();
    part->radius = radius_of(shape);
    if (shape.type == Type::kMesh) {
      auto grid = grid_of(*shape.mesh, cache);
      if (!grid) {
        Error error = std::move(grid).error();
        error.message = "the body \"" + body.name + "\": " + error.message;
        return failure(std::move(error));
      }
      part->grid = std::move(*grid);
    }
    field.reach_ = std::max(field.reach_, shape.body_from_shape.translation.norm() + part->radius);
    field.parts_.push_back(std::move(part));
  }
  return field;
}

std::string distance_cache_folder() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? std::string() : std::string(value);
  };
  const std::filesystem::path chosen = variable("XDG_CACHE_HOME");
  // The specification of these folders ignores relative paths.
  if (chosen.is_absolute()) return (chosen / "retarget").string();
  const std::filesystem::path home = variable("HOME");
  return home.empty() ? std::string() : (home / ".cache" / "retarget").string();
}

}  // namespace retarget
