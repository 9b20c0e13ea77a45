#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "ik/active_set.h"
#include "math/se3.h"

namespace retarget {

/// Edges of a pyramid inside the cone of friction, a column each; upwards they are 1 long.
[[nodiscard]] Eigen::Matrix<double, 3, 4> friction_pyramid(double friction);

/// The wrenches about a point that friction pyramids at some points of support can exert, as the
/// cone of their edges. Forces above torques, scaled as its user likes.
class ForceCone {
 public:
  static constexpr int kEdges = 4;  ///< Of a pyramid, inside the cone of friction.
  static constexpr int kMaxPoints = 10;
  static constexpr int kMaxEdges = kEdges * kMaxPoints;

  ForceCone() { sides_.fill(BoundSide::kLower); }
  /// Takes all points away; where its last projection ended is kept as a beginning for the next.
  void clear() { count_ = 0; }
  /// @param lever  from the point that torques are about, in the unit of length of the torques.
  void add_point(const Eigen::Vector3d& lever, double friction);
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] auto edges() const { return edges_.leftCols(count_); }

 private:
  friend class ConeProjector;
  Eigen::Matrix<double, 6, kMaxEdges> edges_;
  int count_ = 0;
  // those of the last projection that did not bear: the next one begins with them
  std::array<BoundSide, kMaxEdges> sides_{};
};

/// Nearest points of cones: non-negative least squares in the amounts of their edges. Owns its
/// scratch memory.
class ConeProjector {
 public:
  ConeProjector();

  /// @return what of the wrench is outside: it minus the nearest point.
  Vector6d project(ForceCone& cone, const Vector6d& wrench);
  /// Of the last projection: the projector onto what the bearing edges do not span, in which the
  /// rest changes with the wrench.
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
      factor_{};  // rows of the lower triangle
  std::array<double, ForceCone::kMaxEdges> right_{};
  std::array<Vector6d, ForceCone::kMaxEdges> reduced_;
  Eigen::VectorXd lower_, upper_, amounts_;
};

}  // namespace retarget
