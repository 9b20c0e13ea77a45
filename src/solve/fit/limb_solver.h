#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"

namespace retarget {

/// An arm or a leg: a chain of joints, and the tasks whose bodies only this chain moves.
struct FitLimb {
  std::string name;  ///< Name such as `left arm`.
  bool is_arm = false;
  int link = 0;                    ///< First link of the chain; it carries the whole limb.
  std::vector<int> links;          ///< Links of the movable joints, from the first one outwards.
  std::vector<std::size_t> tasks;  ///< Indices into FitModel::tasks.
  /// For each of `links`, whether the joint turns against the mirror image of its counterpart in
  /// the left limb; false for left limbs, and for limbs whose joints have no counterparts.
  std::vector<bool> reversed;
};

/// Largest number of joints of a limb.
inline constexpr int kMaxLimbJoints = 12;

/// Joint positions of a limb, in the order of FitLimb::links; rad or m.
using LimbJoints = std::array<double, kMaxLimbJoints>;

struct LimbRange {
  LimbJoints lower{}, upper{};
};

/// The arms and legs of a model that have tasks, except limbs with more than kMaxLimbJoints joints.
[[nodiscard]] std::vector<FitLimb> find_limbs(const FitModel& model);

/// The position of a limb's joint in a configuration.
[[nodiscard]] inline double& joint_value(const FitModel& model, int link, std::span<double> qpos) {
  return qpos[static_cast<std::size_t>(
      model.tree.links()[static_cast<std::size_t>(link)].qpos_address)];
}

/// Inverse kinematics of one limb, with the rest of the robot fixed. Does not allocate.
class LimbSolver {
 public:
  /// Keeps references to both arguments.
  LimbSolver(const FitModel& model, const FitLimb& limb);

  /// The joint limits.
  [[nodiscard]] const LimbRange& limits() const { return limits_; }

  /// Tracking cost of the limb: the position and rotation terms of FrameTerms for its tasks, but
  /// with the full rotation weight for lying feet.
  [[nodiscard]] double cost(const TreeState& pose, const FrameGoals& goals) const;

  /// Takes damped Gauss-Newton steps inside `range` until the tracking cost has converged.
  /// @param pose, qpos  start, then result; `pose` must be the forward kinematics of `qpos`.
  /// @return the remaining cost. If it is not finite, the configuration is unchanged.
  double solve(const FrameGoals& goals, const LimbRange& range, TreeState& pose,
               std::span<double> qpos) const;

 private:
  const FitModel& model_;
  const FitLimb& limb_;
  LimbRange limits_;
};

}  // namespace retarget
