#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/math/se3.h"
#include "solve/ik/active_set.h"

namespace retarget {

/// Edges of a pyramid inside the friction cone, one per column; their components along the normal
/// are 1.
/// @param normal  of the surface, unit length.
[[nodiscard]] Eigen::Matrix<double, 3, 4> friction_pyramid(
    double friction, const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ());

/// The wrenches about a point that friction pyramids at some support points can exert: the cone
/// spanned by their edges. Forces come first, then torques, in units chosen by the caller.
class ForceCone {
 public:
  static constexpr int kEdges = 4;  ///< Edges of a pyramid inside the friction cone.
  static constexpr int kMaxPoints = 10;
  static constexpr int kMaxEdges = kEdges * kMaxPoints;

  ForceCone() { sides_.fill(BoundSide::kLower); }
  /// Removes all points. Keeps the active set of the last projection as the start of the next.
  void clear() { count_ = 0; }
  /// @param lever  vector from the reference point of the torques, in the torques' unit of length.
  /// @param normal  of the surface, unit length.
  void add_point(const Eigen::Vector3d& lever, double friction,
                 const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ());
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] auto edges() const { return edges_.leftCols(count_); }

 private:
  friend class ConeProjector;
  Eigen::Matrix<double, 6, kMaxEdges> edges_;
  int count_ = 0;
  // Edges without force in the last projection; the next one starts with them. The other edges have
  // amounts, which are not negative.
  std::array<BoundSide, kMaxEdges> sides_{};
  std::array<double, kMaxEdges> amounts_{};
};

/// Projects wrenches onto cones: non-negative least squares in the amounts of the edges. Owns its
/// scratch memory.
class ConeProjector {
 public:
  ConeProjector();

  /// @return the wrench minus the nearest point of the cone. Not finite if the wrench or an edge is
  ///     not.
  Vector6d project(ForceCone& cone, const Vector6d& wrench);
  /// Whether the amounts of the cone's last projection leave at most `rest` of the wrench. If so, the
  /// cone's nearest point is not farther; if not, it may be nearer.
  [[nodiscard]] static bool explains(const ForceCone& cone, const Vector6d& wrench, double rest);
  /// For the last projection: the projector onto the complement of the bearing edges' span. It is
  /// the derivative of the residual with respect to the wrench.
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
  std::vector<int> bearing_;
  std::array<double, static_cast<std::size_t>(ForceCone::kMaxEdges) * ForceCone::kMaxEdges>
      factor_{};  // Rows of the lower triangle.
  std::array<double, ForceCone::kMaxEdges> right_{};
  std::array<Vector6d, ForceCone::kMaxEdges> reduced_;
  Eigen::VectorXd lower_, upper_, amounts_;
};

}  // namespace retarget
