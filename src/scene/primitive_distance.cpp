#include "scene/primitive_distance.h"

#include <algorithm>
#include <cmath>

namespace retarget {

using Eigen::Vector3d;

namespace {

// Normalises the offset from a centre; a zero offset has no direction.
Vector3d direction_of(const Vector3d& offset, double length, const Vector3d& otherwise) {
  return length > 0.0 ? Vector3d(offset / length) : otherwise;
}

double sign_of(double value) {
  return value < 0.0 ? -1.0 : 1.0;
}

}  // namespace

SurfaceDistance distance_to_plane(const Vector3d& point) {
  return {point.z(), Vector3d::UnitZ()};
}

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

SurfaceDistance distance_to_capsule(double radius, double half_length, const Vector3d& point) {
  const double nearest = std::clamp(point.z(), -half_length, half_length);
  const Vector3d offset = point - Vector3d(0.0, 0.0, nearest);
  const double length = offset.norm();
  const bool at_end = std::abs(point.z()) >= half_length;
  const Vector3d otherwise =
      at_end ? Vector3d(sign_of(point.z()) * Vector3d::UnitZ()) : Vector3d::UnitX();
  return {length - radius, direction_of(offset, length, otherwise)};
}

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

}  // namespace retarget
