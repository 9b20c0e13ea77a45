#pragma once

#include <optional>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/measure.h"
#include "retarget/robot.h"
#include "retarget/scene.h"
#include "retarget/solve.h"
#include "retarget/solved_scene.h"

namespace RETARGET_API retarget {

/// The scene of a motion, for display on a page.
struct MotionScene {
  SceneClip robot;  ///< Scene around the robot, in the frames of the motion or its source.
  std::optional<SceneClip> human;  ///< Scene around the human, in the source's frames; empty: none.
  double scale = 1.0;      ///< Scale of static bodies from the human's to the robot's scene.
  ContactLabels contacts;  ///< Contacts with bodies of the scene and the floor, in the same frames.
};

/// The scene of a solved motion, transformed by `normalize_start` like its file; empty without a
/// scene.
[[nodiscard]] std::optional<MotionScene> motion_scene(const Motion& motion);

/// The scene around a robot whose motion is compared with a source, as a fit makes it; empty if the
/// source has no scene. Its contacts are those that a fit would enforce.
/// @param lead_in  whether the motion includes the source's lead-in.
/// Errors: a robot whose limbs cannot be measured (kConfig).
[[nodiscard]] Result<std::optional<MotionScene>> motion_scene(const MeasuredSource& source,
                                                              bool lead_in, const Robot& robot);

}  // namespace retarget
