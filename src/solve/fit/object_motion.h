#pragma once

#include <span>
#include <string>
#include <vector>

#include "solve/fit/fit_model.h"
#include "solve/fit/fit_scene.h"

namespace retarget {

/// Displacement of an object.
struct ObjectMove {
  std::string body;
  double farthest = 0.0;  ///< Of its centre of mass, metres.
};

/// Moves the objects of a solved clip with the parts of the robot that hold them: by the rigid
/// motion that brings their surfaces to these parts, and back to where parts are held
/// (hold_contacts). At rest, an object only shifts and turns on its ground; between contacts the
/// motion is interpolated. The goals of the scene move with the objects.
/// @param qpos  frame-major, laid out as in RobotClip.
/// @return the objects that are held in at least one frame.
std::vector<ObjectMove> follow_hands(const FitModel& model, std::span<const double> qpos,
                                     double frame_time, FitScene& scene);

}  // namespace retarget
