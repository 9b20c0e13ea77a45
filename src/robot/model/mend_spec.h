#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "robot/model/load_model.h"

namespace retarget {

/// Returns the elements of a kind, in order; elements may be deleted while iterating over the list.
[[nodiscard]] std::vector<mjsElement*> elements_of(mjSpec* spec, mjtObj kind);

/// Gives bodies whose masses MuJoCo rejects (negative, not finite, an inertia without positive
/// principal moments: dummies, rods, export errors) small ones, which do not affect kinematics.
/// @return the names of those bodies.
std::vector<std::string> mend_inertias(mjSpec* spec);

/// Removes the joints that move a model's root through the world, if one of them is a slide: those
/// of the topmost body and of the unbranched chain below it. The robot is the subtree with the most
/// joints.
/// @param spec  a model without a free joint.
/// @return the names of the joints; empty if the root does not slide.
std::vector<std::string> free_sliding_root(mjSpec* spec);

/// Locks ball joints that carry no other joint, such as rod ends and tendon hooks.
/// @return the names of the joints.
std::vector<std::string> hold_loose_balls(mjSpec* spec);

/// Returns the robot's topmost body: the one with the most joints below it; null in an empty model.
[[nodiscard]] mjsBody* robot_base(mjSpec* spec);

/// Returns the body pairs of `connect` and `weld` constraints, except those attached to the world.
[[nodiscard]] std::vector<TiedBodies> tied_bodies(mjSpec* spec);

}  // namespace retarget
