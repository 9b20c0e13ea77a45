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
  SceneClip robot;  ///< The robot's world, in the frames of the motion or its source.
  std::optional<SceneClip> human;  ///< The human's world, in the frames of the source; empty: none.
  double scale = 1.0;      ///< Size of static bodies, from the human's world to the robot's.
  ContactLabels contacts;  ///< With bodies of the scene and the floor, in the same frames.
};

/// The scene of a solved motion, moved like its file by `normalize_start`; empty if it has none.
[[nodiscard]] std::optional<MotionScene> motion_scene(const Motion& motion);

/// The scene of a motion that is measured against a source, as a fit makes it for this robot; empty
/// if the source has none. Its contacts are those that a fit would enforce.
/// @param lead_in  whether the motion includes the source's lead-in.
/// Errors: a robot whose limbs cannot be measured (kConfig).
[[nodiscard]] Result<std::optional<MotionScene>> motion_scene(const MeasuredSource& source,
                                                              bool lead_in, const Robot& robot);

}  // namespace retarget
