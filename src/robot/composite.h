#pragma once

#include <Eigen/Core>
#include <span>

#include "robot/kinematic_tree.h"

namespace retarget {

/// The quadratic form 1/2 V'AV + b'V in the motion V = [v; w] of a link and all that it carries: v
/// the velocity of the point at the base's origin if it moved along, w the angular velocity, both
/// in world axes. A sum of squared residuals that depend on V.
struct Composite {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Zero();  ///< A = [linear, mixed; mixed', angular].
  Eigen::Matrix3d mixed = linear, angular = linear;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< b = [force; torque].
  Eigen::Vector3d torque = force;

  void operator+=(const Composite& other) {
    linear += other.linear;
    mixed += other.mixed;
    angular += other.angular;
    force += other.force;
    torque += other.torque;
  }
};

/// Hessian and gradient over a tree's degrees of freedom of a sum of such forms: with the motion
/// subspace S_i of each and A_i, b_i summed over its subtree, as composite inertias are
/// (Featherstone, "Rigid Body Dynamics Algorithms", section 6.2), H_ij = S_j'A_i S_i for every j
/// that carries i, g_i = S_i'b_i.
/// @param composites  by link, of what hangs on it alone; on return of all that it carries.
/// @param hessian     rows as KinematicTree::row_begin says, written.
/// @param gradient    dof_count() values, written.
void assemble(const TreeState& state, std::span<Composite> composites, std::span<double> hessian,
              std::span<double> gradient);

/// The lower triangle of a matrix that is kept as such rows, zeros included.
/// @param stride  from one row of the whole matrix to the next.
void write_lower_triangle(const KinematicTree& tree, std::span<const double> rows, double* matrix,
                          int stride);

}  // namespace retarget
