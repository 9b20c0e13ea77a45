#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/math/se3.h"
#include "solve/ik/active_set.h"

namespace retarget {

/// Edges of a pyramid inside the friction cone, one per column. Each has a normal component of 1.
/// @param friction  friction coefficient.
/// @param normal    surface normal, unit length.
/// @param forward   horizontal direction, unit length: two edges lie in its plane with the normal.
///     With that of the base (turn_about_vertical()), results do not depend on the heading. The
///     metrics of dynamics keep x, because the tracking predictor was fitted to them.
[[nodiscard]] Eigen::Matrix<double, 3, 4> friction_pyramid(
    double friction, const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ(),
    const Eigen::Vector3d& forward = Eigen::Vector3d::UnitX());

/// The contact wrench cone: the wrenches about a reference point that contact forces inside the
/// friction pyramids of some support points can exert. A wrench contains the force, then the
/// torque, in units that the caller chooses.
class ForceCone {
 public:
  static constexpr int kEdges = 4;  ///< Edges of a pyramid inside the friction cone.
  static constexpr int kMaxPoints = 10;
  static constexpr int kMaxEdges = kEdges * kMaxPoints;

  ForceCone() { sides_.fill(BoundSide::kLower); }
  /// Removes all points. Keeps the active set of the last projection as a warm start for the next.
  void clear() { count_ = 0; }
  /// Adds a contact; ignored if the cone already has kMaxPoints.
  /// @param lever     vector from the reference point to the contact, in the unit of length of the
  ///     torques.
  /// @param friction  friction coefficient.
  /// @param normal, forward  see friction_pyramid().
  void add_point(const Eigen::Vector3d& lever, double friction,
                 const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ(),
                 const Eigen::Vector3d& forward = Eigen::Vector3d::UnitX());
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] auto edges() const { return edges_.leftCols(count_); }

 private:
  friend class ConeProjector;
  Eigen::Matrix<double, 6, kMaxEdges> edges_;
  int count_ = 0;
  // Active set of the last projection, a warm start for the next: edges at kLower bear no force.
  // The amounts are those of the free edges.
  std::array<BoundSide, kMaxEdges> sides_{};
  std::array<double, kMaxEdges> amounts_{};
};

/// Projects wrenches onto cones by non-negative least squares in the edge amounts. Owns its scratch
/// memory.
class ConeProjector {
 public:
  ConeProjector();

  /// @return the residual: the wrench minus the nearest point of the cone. Not finite if the wrench
  ///     or an edge is not finite.
  Vector6d project(ForceCone& cone, const Vector6d& wrench);
  /// Whether the edge amounts of the cone's last projection leave a residual of at most `rest`. A
  /// cheap sufficient test: if it fails, a new projection may still have a smaller residual.
  [[nodiscard]] static bool explains(const ForceCone& cone, const Vector6d& wrench, double rest);
  /// Derivative of the last projection's residual with respect to the wrench: the projector onto
  /// the orthogonal complement of the bearing edges.
  [[nodiscard]] Matrix6d complement();

 private:
  class System;
  bool minimise(const std::vector<BoundSide>& sides, Eigen::VectorXd& minimum);
  bool factorise();
  double gradient(int i, const Eigen::VectorXd& x);

  ActiveSet active_;
  const ForceCone* cone_ = nullptr;
  Vector6d wrench_, rest_;
  bool rest_is_known_ = false;
  std::vector<int> bearing_;  // Edges with a non-zero amount.
  std::array<double, static_cast<std::size_t>(ForceCone::kMaxEdges) * ForceCone::kMaxEdges>
      factor_{};  // Rows of the lower triangle.
  std::array<double, ForceCone::kMaxEdges> right_{};
  std::array<Vector6d, ForceCone::kMaxEdges> reduced_;
  Eigen::VectorXd lower_, upper_, amounts_;
};

}  // namespace retarget
