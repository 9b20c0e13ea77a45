#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "fit/fit_model.h"
#include "fit/frame_terms.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// An arm or a leg: a chain of joints and the tasks that it alone serves.
struct FitLimb {
  std::string name;        ///< `left arm`
  int link = 0;            ///< The first one; all that it carries moves with it.
  std::vector<int> links;  ///< Of the joints of the chain that can move, the first one first.
  std::vector<std::size_t> tasks;  ///< Indices into FitModel::tasks.
};

/// No limb has more joints.
inline constexpr int kMaxLimbJoints = 12;

/// The joints of a limb, in the order of FitLimb::links.
using LimbJoints = std::array<double, kMaxLimbJoints>;

/// Between which values each of them stays.
struct LimbRange {
  LimbJoints lower{}, upper{};
};

/// The arms and legs of a model; without those that follow nothing.
[[nodiscard]] std::vector<FitLimb> find_limbs(const FitModel& model);

/// The value of a limb's joint in a configuration.
[[nodiscard]] inline double& joint_value(const FitModel& model, int link, std::span<double> qpos) {
  return qpos[static_cast<std::size_t>(
      model.tree.links()[static_cast<std::size_t>(link)].qpos_address)];
}

/// Moves one limb of a robot that stays otherwise where it is. Allocates nothing.
class LimbSolver {
 public:
  /// Keeps references to both.
  LimbSolver(const FitModel& model, const FitLimb& limb);

  /// The joints' limits.
  [[nodiscard]] const LimbRange& limits() const { return limits_; }

  /// What tracking costs on the limb, as FrameTerms has it.
  [[nodiscard]] double cost(const TreeState& pose, const FrameGoals& goals) const;

  /// Damped Gauss-Newton steps inside a range, until they lower that cost by little.
  /// @param pose, qpos  where to begin, and where it ends; the pose is that of `qpos`.
  /// @return the cost that is left.
  double solve(const FrameGoals& goals, const LimbRange& range, TreeState& pose,
               std::span<double> qpos) const;

 private:
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxLimbJoints, 1>;
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxLimbJoints, kMaxLimbJoints>;

  [[nodiscard]] int count() const { return static_cast<int>(limb_.links.size()); }
  void assemble(const TreeState& pose, const FrameGoals& goals, Matrix& hessian,
                Vector& gradient) const;
  void hold_limits(const Vector& joints, const LimbRange& range, Matrix& hessian,
                   Vector& gradient) const;
  void place(const Vector& joints, const LimbRange& range, TreeState& pose,
             std::span<double> qpos) const;

  const FitModel& model_;
  const FitLimb& limb_;
  LimbRange limits_;
};

}  // namespace retarget
