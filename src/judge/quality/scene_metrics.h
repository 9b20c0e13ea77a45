#pragma once

#include <vector>

#include "human/gait/source_feet.h"
#include "judge/quality/report_parts.h"
#include "retarget/contact_plan.h"
#include "retarget/human.h"
#include "retarget/retargeting_config.h"
#include "scene/scene_world.h"

namespace retarget {

/// Input of the scene metrics.
struct SceneSource {
  const SceneWorld& world;  ///< Scene around the human, in the frames of the motion.
  const HumanClip& human;
  const SourceFeet& feet;
  const ContactPlan& contacts;               ///< Contacts of the human's feet with this scene.
  double scale = 1.0;                        ///< Scale from the human's to the robot's paths.
  const SceneWorld* around_robot = nullptr;  ///< Scene around the robot; null: scaled_world().
  double pace = 1.0;                         ///< Of the motion, see QualitySource::pace.
};

/// Measures contacts and penetration between a robot and its scene in the first `frames` frames.
/// @return by frame: whether the robot is within 2 cm of a body of the scene.
std::vector<char> measure_scene(const ReportBuilder& draft, const ResolvedConfig& config,
                                const SceneSource& source, int frames);

}  // namespace retarget
