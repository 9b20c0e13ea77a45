#pragma once

#include <Eigen/Core>
#include <vector>

#include "dynamics/inertias.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// How a robot's centre of mass and its angular momentum about it depend on the velocities of its
/// degrees of freedom: the Jacobian of the centre of mass, and the angular part of the centroidal
/// momentum matrix (Orin, Goswami and Lee, "Centroidal dynamics of a humanoid robot", 2013). Rotors
/// are left out. Owns its scratch memory: no allocation in update.
class CentroidalMap {
 public:
  using Rows = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  CentroidalMap(const KinematicTree& tree, const Inertias& inertias);

  void update(const TreeState& state);

  [[nodiscard]] const Eigen::Vector3d& com() const { return com_; }  ///< World, m.
  /// By degree of freedom: velocity of the centre of mass, m/s, above angular momentum, kg m^2/s;
  /// world axes.
  [[nodiscard]] const Rows& rows() const { return rows_; }

 private:
  // a link and all that it carries, seen from the base's origin
  struct Carried {
    double mass;
    Eigen::Vector3d first_moment;
    Eigen::Matrix3d inertia;
  };

  const KinematicTree* tree_;
  const Inertias* inertias_;
  std::vector<Carried> carried_;
  Eigen::Vector3d com_ = Eigen::Vector3d::Zero();
  Rows rows_;
};

}  // namespace retarget
