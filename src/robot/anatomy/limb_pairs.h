#pragma once

#include <array>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"
#include "robot/anatomy/branches.h"
#include "robot/anatomy/limb_shape.h"

namespace retarget {

/// Shapes of a pair's limbs; index 0 is the first branch, towards which `across` points.
struct ShapedPair {
  BranchPair pair;
  std::array<LimbShape, 2> limbs;
};

/// The pairs of branches that are a robot's legs and arms, left and right in any order.
struct LimbPairs {
  ShapedPair legs;  ///< Without joints for a robot with a fixed base.
  ShapedPair arms;
  double lean = 0.0;  ///< Lean of the line from hips to shoulders, degrees; 0 without legs.
};

/// Chooses the legs, the pair of branches that reaches lowest, and the arms, the remaining pair
/// with the most joints; for a robot with a fixed base only the arms, the highest pair.
///
/// @param posed  the tree in the configuration `reference` (reference_configuration).
/// @param file  the model, for errors (kConfig): those of find_limbs that concern legs and arms.
[[nodiscard]] Result<LimbPairs> find_limb_pairs(const Robot& robot, const TreeState& posed,
                                                const std::vector<double>& reference,
                                                const std::string& file);

/// The error that a model is not a humanoid with two legs and two arms.
/// @param found  what it is instead.
/// @param hint  what to check; a fixed base is suggested in any case.
[[nodiscard]] Failure no_legs_failure(const std::string& file, const std::string& found,
                                      const std::string& hint = {});

}  // namespace retarget
