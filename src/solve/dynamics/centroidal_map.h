#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/dynamics/inertias.h"

namespace retarget {

/// The Jacobian of a robot's centre of mass, and the angular part of its centroidal momentum matrix
/// (Orin, Goswami and Lee, "Centroidal dynamics of a humanoid robot", 2013). It maps the velocities
/// of the degrees of freedom to the velocity of the centre of mass and to the angular momentum
/// about it. Ignores rotors. Owns its scratch memory; update() does not allocate.
class CentroidalMap {
 public:
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  CentroidalMap(const KinematicTree& tree, const Inertias& inertias);

  /// Computes com() and rows() for a pose.
  void update(const TreeState& state);

  [[nodiscard]] const Eigen::Vector3d& com() const { return com_; }  ///< World, metres.
  /// One column per degree of freedom: velocity of the centre of mass, m/s (first three rows), and
  /// angular momentum, kg m^2/s; world axes.
  [[nodiscard]] const Rows& rows() const { return rows_; }

 private:
  // Composite body of a link and its descendants, about the base's origin, world axes.
  struct Carried {
    double mass;
    Eigen::Vector3d first_moment;  // Mass times centre of mass.
    Eigen::Matrix3d inertia;
  };

  const KinematicTree* tree_;
  const Inertias* inertias_;
  std::vector<Carried> carried_;
  Eigen::Vector3d com_ = Eigen::Vector3d::Zero();
  Rows rows_;
};

}  // namespace retarget
