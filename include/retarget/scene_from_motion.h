#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/contact_plan.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/scene.h"

namespace RETARGET_API retarget {

/// A raised surface on which a human rests.
struct FoundSurface {
  std::string body;     ///< Body of the scene: `step_1`, `seat_1`, `rest_1` (hands).
  double height = 0.0;  ///< Metres above the floor.
  Eigen::Vector2d size = Eigen::Vector2d::Zero();  ///< Sides of the box, metres.
  int rests = 0;                                   ///< Number of stances and rests on it.
  double first = 0.0, last = 0.0;  ///< Begin of the first and end of the last one, seconds.
};

/// The scene around a human, derived from its motion.
struct SceneFromMotion {
  Scene scene;
  std::vector<FoundSurface> surfaces;  ///< One per body of the scene.
};

/// Finds boxes on which a human steps, sits or leans, from the motion alone.
///
/// * Steps: stances on a sole that is raised, in which the foot carries the body: the other foot
///   does not stand lower for at least 0.1 s.
/// * Seats: the hips rest for 0.5 s in the height of a sitting body, with level thighs, and farther
///   behind the feet than a squatting body could be. Planks and bridges, a flat trunk that arms or
///   shoulders and feet carry, do not sit.
/// * Rests of hands: a hand stays within 2 cm for 0.5 s while its shoulder moves by more than 10
///   cm.
///
/// Rests at the same height that are near each other share a box, unless the human stands lower in
/// between. A box is the smallest rectangle around them, with a margin, from the floor up; under a
/// hand it is 5 cm thick. Nothing is known about objects that the human does not touch.
/// @return a scene without bodies if the human only rests on the floor.
/// Errors (kInput): the human has no feet.
[[nodiscard]] Result<SceneFromMotion> scene_from_motion(const Clip& clip,
                                                        const Calibration& calibration,
                                                        const ContactOptions& options = {});

/// The surfaces as a table with one line each.
[[nodiscard]] std::string surfaces_text(const SceneFromMotion& found);

}  // namespace retarget
