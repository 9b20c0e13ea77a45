#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"
#include "retarget/scene.h"

namespace RETARGET_API retarget {

/// Density of moving bodies whose mass is unknown, kg/m^3: that of a packed parcel.
inline constexpr double kObjectDensity = 200.0;

/// Checks that the extension of a file selects a format of format_scene. Errors (kUsage).
[[nodiscard]] Result<void> check_scene_ending(const std::string& file);

/// Formats a robot's scene in the format of the file's extension: `.xml`, `.json` or `.obj`.
/// @param motion  motion of the robot, with the frames of the scene.
/// Errors: those of check_scene_ending and of the formats.
[[nodiscard]] Result<std::string> format_scene(const std::string& file, const RobotClip& motion,
                                               const SceneClip& scene);

/// Formats a robot and its scene as an MJCF model, which needs no other files.
///
/// The robot is as loaded: primitives, no actuators, with the torque limits and rotor inertias of
/// its profile. Static bodies follow as bodies without joints, moving ones with a free joint, so a
/// configuration is the robot's, then position (metres) and quaternion wxyz of each object in the
/// order of the scene. Names of the scene are kept, with a number added where the robot has the
/// same name. Moving bodies have their mass, or that of kObjectDensity. There is a floor z = 0
/// unless the robot's model has a plane. Keyframes `start` and `end`: first and last frame.
///
/// Errors (kRun): a shape that MuJoCo rejects, such as a mesh without volume.
[[nodiscard]] Result<std::string> format_scene_mjcf(const RobotClip& motion,
                                                    const SceneClip& scene);

/// Formats a scene as the JSON that load_scene reads (docs/world.md), with its bodies as in the
/// first frame. Meshes are part of the file.
[[nodiscard]] std::string format_scene_json(const SceneClip& scene);

/// Formats the static bodies of a scene as an OBJ file, one object per body; metres, Z up. Round
/// shapes become triangles with 32 sides, a plane a square of 100 m.
[[nodiscard]] std::string format_scene_obj(const SceneClip& scene);

}  // namespace retarget
