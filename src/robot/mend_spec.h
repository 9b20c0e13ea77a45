#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "robot/load_model.h"

namespace retarget {

/// Elements of a kind, in order; they may be deleted while the list is gone through.
[[nodiscard]] std::vector<mjsElement*> elements_of(mjSpec* spec, mjtObj kind);

/// Gives bodies whose masses MuJoCo refuses (negative, not finite, an inertia without positive
/// principal moments: dummies, rods, export errors) small ones, which move no body.
/// @return the names of those bodies.
std::vector<std::string> mend_inertias(mjSpec* spec);

/// Takes away the joints by which a model's root moves through the world, where one of them is a
/// slide: those of the topmost body and of bodies without branches below it. The robot is what
/// carries the most joints.
/// @return the names of the joints; empty: the root does not slide.
std::vector<std::string> free_sliding_root(mjSpec* spec);

/// Holds ball joints that carry no other joint: ends of rods, tendons' hooks.
/// @return the names of the joints.
std::vector<std::string> hold_loose_balls(mjSpec* spec);

/// The robot's topmost body, which has the most joints below it; null in an empty model.
[[nodiscard]] mjsBody* robot_base(mjSpec* spec);

/// The bodies that MuJoCo's `connect` and `weld` tie to each other, not those tied to the world.
[[nodiscard]] std::vector<TiedBodies> tied_bodies(mjSpec* spec);

}  // namespace retarget
