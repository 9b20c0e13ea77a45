#pragma once

#include <Eigen/Core>
#include <span>

#include "retarget/kinematic_tree.h"

namespace retarget {

/// The quadratic form 1/2 V'AV + b'V in the motion V = [v; w] of a link and its subtree: a sum of
/// squared residuals that depend on V. v is the velocity of the body-fixed point at the base's
/// origin, w the angular velocity; both are in world axes.
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

/// Assembles Hessian and gradient of a sum of such forms over the tree's degrees of freedom, as in
/// the composite rigid body algorithm (Featherstone, "Rigid Body Dynamics Algorithms", section
/// 6.2): with the motion subspace S_i of a degree of freedom, and A_i, b_i summed over its subtree,
/// H_ij = S_j'A_i S_i for every j that carries i, g_i = S_i'b_i.
/// @param composites  one per link: on entry the form of the link alone, on return that of its
///   subtree.
/// @param hessian     rows in the layout of KinematicTree::row_begin; overwritten.
/// @param gradient    dof_count() values; overwritten.
void assemble(const TreeState& state, std::span<Composite> composites, std::span<double> hessian,
              std::span<double> gradient);

/// Writes the lower triangle of a matrix stored in that row layout, zeros included.
/// @param stride  distance between rows of the full matrix.
void write_lower_triangle(const KinematicTree& tree, std::span<const double> rows, double* matrix,
                          int stride);

}  // namespace retarget
