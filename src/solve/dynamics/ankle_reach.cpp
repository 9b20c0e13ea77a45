#include "solve/dynamics/ankle_reach.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>

namespace retarget {
namespace {

using Eigen::Vector3d;

// A contact force on a sole; axes of the foot's link.
struct SoleForce {
  Vector3d normal;  // Of the sole.
  Vector3d force;   // Newtons.
};

// Moves a point along the sole until the torque of the force about an axis is at most `limit`.
Vector3d within_torque(const Vector3d& anchor, const Vector3d& axis, const SoleForce& sole,
                       double limit, const Vector3d& point) {
  const Vector3d across = sole.force.cross(axis);
  const Vector3d along = across - across.dot(sole.normal) * sole.normal;
  const double per_way = along.squaredNorm();
  // A joint axis that is nearly parallel to the force has no lever arm, so no torque is required.
  constexpr double kNoLever = 0.1;
  if (!(per_way >= kNoLever * sole.force.squaredNorm())) return point;
  const double torque = (point - anchor).dot(across);
  if (std::abs(torque) <= limit) return point;
  return point - (torque - std::copysign(limit, torque)) / per_way * along;
}

}  // namespace

Vector3d within_ankle_reach(const KinematicTree& tree, std::span<const double> torque_limits,
                            int foot, const Vector3d& normal, const Vector3d& force,
                            const Vector3d& point) {
  constexpr double kNear = 0.1;  // Largest distance between the two axes of an ankle, metres.
  const KinematicTree::Link& link = tree.links()[static_cast<std::size_t>(foot)];
  Vector3d moved = point;
  if (link.slides || foot == 0) return moved;
  const SoleForce sole{normal, force};
  const double own = torque_limits[static_cast<std::size_t>(foot)];
  if (std::isfinite(own)) {
    moved = within_torque(Vector3d::Zero(), Vector3d::UnitZ(), sole, own, moved);
  }
  if (link.parent <= 0 || tree.links()[static_cast<std::size_t>(link.parent)].slides ||
      link.parent_from_link.translation.norm() > kNear) {
    return moved;
  }
  const double parents = torque_limits[static_cast<std::size_t>(link.parent)];
  if (!std::isfinite(parents)) return moved;
  const Eigen::Quaterniond link_from_parent = link.parent_from_link.rotation.conjugate();
  const Vector3d anchor = -(link_from_parent * link.parent_from_link.translation);
  return within_torque(anchor, link_from_parent * Vector3d::UnitZ(), sole, parents, moved);
}

}  // namespace retarget
