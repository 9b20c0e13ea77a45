#include "solve/dynamics/ankle_reach.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

namespace retarget {
namespace {

using Eigen::Vector3d;

// Moves a point across an axis until its lever is at most `reach`.
Vector3d within_reach(const Vector3d& anchor, const Vector3d& axis, const Vector3d& normal,
                      double reach, const Vector3d& point) {
  // The torque of a force along the normal is its size times the component along `across`.
  const Vector3d across = normal.cross(axis);
  const double square = across.squaredNorm();
  constexpr double kNoLever = 0.1;  // Joints that turn about the normal need no torque.
  if (square < kNoLever) return point;
  const double lever = (point - anchor).dot(across);
  if (std::abs(lever) <= reach) return point;
  return point - (lever - std::copysign(reach, lever)) / square * across;
}

}  // namespace

Vector3d within_ankle_reach(const KinematicTree& tree, std::span<const double> torque_limits,
                            int foot, const Vector3d& normal, double force, const Vector3d& point) {
  constexpr double kNear = 0.1;  // Metres between two axes of one ankle.
  const KinematicTree::Link& link = tree.links()[static_cast<std::size_t>(foot)];
  Vector3d moved = point;
  if (link.slides || foot == 0) return moved;
  const double own = torque_limits[static_cast<std::size_t>(foot)] / force;
  if (std::isfinite(own)) {
    moved = within_reach(Vector3d::Zero(), Vector3d::UnitZ(), normal, own, moved);
  }
  if (link.parent <= 0 || tree.links()[static_cast<std::size_t>(link.parent)].slides ||
      link.parent_from_link.translation.norm() > kNear) {
    return moved;
  }
  const double parents = torque_limits[static_cast<std::size_t>(link.parent)] / force;
  if (!std::isfinite(parents)) return moved;
  const Eigen::Quaterniond link_from_parent = link.parent_from_link.rotation.conjugate();
  const Vector3d anchor = -(link_from_parent * link.parent_from_link.translation);
  return within_reach(anchor, link_from_parent * Vector3d::UnitZ(), normal, parents, moved);
}

}  // namespace retarget
