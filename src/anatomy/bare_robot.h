#pragma once

#include <memory>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot whose soles nobody told, with those that make_robot would have found.
struct CompletedRobot {
  std::shared_ptr<const Robot> robot;
  std::string note;      ///< Where the soles are from, for people: `from mesh vertices`.
  bool guessed = false;  ///< The soles have human proportions: nothing in the model tells them.
  int shapeless = 0;     ///< Parts that have neither a sphere, capsule or box nor a mesh.
  /// Bodies that overlap by the model itself, for people; their contact is no fault (overlaps.h).
  std::vector<std::string> overlaps;
};

/// Gives a robot without soles (it has no profile, or one that leaves them out) soles, and, where
/// none are named, the contacts that are no fault: from its limbs and its model's geoms and meshes
/// (find_shapes). Bodies without a primitive get the shape of their mesh; rougher ones, which stand
/// for cylinders or are guessed, are left out, for a motion is measured by them. Everything else
/// stays: names, tree, joint order, ranges, speeds.
///
/// @param model_path  that the robot was loaded from; its meshes may be missing.
/// Errors (kConfig): what find_limbs refuses.
[[nodiscard]] Result<CompletedRobot> complete_bare_robot(const Robot& bare,
                                                         const std::string& model_path);

}  // namespace retarget
