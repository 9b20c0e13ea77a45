#pragma once

#include <span>
#include <string>
#include <vector>

#include "solve/fit/fit_model.h"
#include "solve/fit/fit_scene.h"

namespace retarget {

/// Displacement of an object from its original path.
struct ObjectMove {
  std::string body;       ///< Name of the object.
  double farthest = 0.0;  ///< Largest displacement of its centre of mass, metres.
};

/// Moves the objects of a solved clip with the parts of the robot that hold them. In each frame,
/// the rigid displacement is the least-squares solution that brings the surface to these parts and
/// the held contact positions (hold_contacts()) to their middles. An object at rest only shifts and
/// turns on its ground. Between contacts, the displacement is interpolated. The scene's goals move
/// with the objects.
/// @param qpos  frame-major, laid out as in RobotClip.
/// @return the objects that are held in at least one frame.
std::vector<ObjectMove> follow_hands(const FitModel& model, std::span<const double> qpos,
                                     double frame_time, FitScene& scene);

}  // namespace retarget
