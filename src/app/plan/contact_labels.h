#pragma once

#include "retarget/human.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/solved_scene.h"

namespace retarget {

/// Names the contacts of a motion by the robot's bodies: those of feet and, in a scene, of other parts.
/// @param frame_count  of the motion; contacts end there.
/// @param feet  contacts of the human's heels and toes.
/// @param scene  null: only the floor, under the feet.
[[nodiscard]] ContactLabels make_contact_labels(const Robot& robot, const ResolvedConfig& config,
                                                int frame_count, const SourceContacts& feet,
                                                const SolvedScene* scene);

}  // namespace retarget
