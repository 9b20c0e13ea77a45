#pragma once

#include <memory>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot whose profile has no soles, completed as make_robot would do it.
struct CompletedRobot {
  std::shared_ptr<const Robot> robot;
  std::string note;      ///< Human-readable source of the soles: `from mesh vertices`.
  bool guessed = false;  ///< True if the soles have human proportions because the model does not
                         ///< define them.
  int shapeless = 0;     ///< Bodies with neither a sphere, capsule or box nor a mesh.
  /// Human-readable: bodies that overlap in the model itself; their contact is allowed
  /// (overlaps.h).
  std::vector<std::string> overlaps;
};

/// Adds soles to a robot without any (no profile, or one without soles) and, if its profile allows
/// no contacts, allowed self-contacts. Both come from its limbs and its model's geoms and meshes
/// (find_shapes). Bodies without a primitive get a shape fitted to their mesh. Rougher shapes,
/// which represent cylinders or are estimated, are excluded because metrics depend on them. Names,
/// tree, joint order, ranges and speed limits do not change.
///
/// @param model_path  model that the robot was loaded from; its meshes may be missing.
/// Errors (kConfig): those of find_limbs.
[[nodiscard]] Result<CompletedRobot> complete_bare_robot(const Robot& bare,
                                                         const std::string& model_path);

}  // namespace retarget
