#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "dynamics/inertias.h"
#include "math/gravity.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// What acts on a body about a point: world axes, N and N m.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

/// The forces that a movement needs, without contacts: recursive Newton-Euler (Featherstone, "Rigid
/// Body Dynamics Algorithms", chapter 5), in world axes. Owns its scratch memory: no allocation in
/// compute. The inertias must stay where they are.
class InverseDynamics {
 public:
  explicit InverseDynamics(const KinematicTree& tree, const Inertias& inertias);

  /// @param state         in the configuration in question.
  /// @param velocity      by degree of freedom of the tree: 0-2 of the base's origin in the world,
  ///     3-5 angular in the base's own axes, then of the joints. Per second.
  /// @param acceleration  their rates.
  void compute(const TreeState& state, std::span<const double> velocity,
               std::span<const double> acceleration);

  /// Generalised forces by degree of freedom: force on the base in the world, N; torque about its
  /// origin in its own axes, N m; joints' N m, or N of slides.
  [[nodiscard]] std::span<const double> forces() const { return forces_; }
  /// Centre of mass of the whole robot in the world, m, and its acceleration, m/s^2.
  [[nodiscard]] const Eigen::Vector3d& com() const { return com_; }
  [[nodiscard]] Eigen::Vector3d com_acceleration() const;
  /// What the world has to exert, about the centre of mass: m (c'' + g), and the rate of the
  /// angular momentum about it. Rotors' spin is left out.
  [[nodiscard]] const Wrench& needed() const { return needed_; }
  /// Of a point in the world that moves with a link, m/s.
  [[nodiscard]] Eigen::Vector3d velocity_of(int link, const Eigen::Vector3d& point,
                                            const TreeState& state) const;
  /// About the centre of mass, kg m^2/s.
  [[nodiscard]] const Eigen::Vector3d& angular_momentum() const { return angular_momentum_; }

 private:
  struct LinkMotion {
    Eigen::Vector3d velocity, angular;           // of the link's origin
    Eigen::Vector3d acceleration, angular_rate;  // with gravity as an acceleration upwards
  };

  void move_links(const TreeState& state, std::span<const double> velocity,
                  std::span<const double> acceleration);
  void weigh_links(const TreeState& state);
  void gather_forces(const TreeState& state, std::span<const double> acceleration);

  const KinematicTree* tree_;
  const Inertias* inertias_;
  std::vector<LinkMotion> motions_;
  std::vector<Wrench> wrenches_;  // on a link and what it carries, about the link's origin
  std::vector<double> forces_;
  Eigen::Vector3d com_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_momentum_ = com_;
  Wrench needed_;
};

}  // namespace retarget
