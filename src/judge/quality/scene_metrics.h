#pragma once

#include <vector>

#include "human/gait/source_feet.h"
#include "human/skeleton/human_clip.h"
#include "judge/quality/report_parts.h"
#include "retarget/contact_plan.h"
#include "retarget/retargeting_config.h"
#include "scene/scene_world.h"

namespace retarget {

/// Input of the scene metrics.
struct SceneSource {
  const SceneWorld& world;  ///< Around the human, in the frames of the motion.
  const HumanClip& human;
  const SourceFeet& feet;
  const ContactPlan& contacts;               ///< Of the human's feet on this scene.
  double scale = 1.0;                        ///< From the human's to the robot's paths.
  const SceneWorld* around_robot = nullptr;  ///< Null: `world`, scaled (scaled_world).
};

/// Measures how a robot touches and penetrates its scene over the first `frames` frames.
/// @return by frame: whether the robot is within 2 cm of a body of the scene.
std::vector<char> measure_scene(const ReportBuilder& draft, const ResolvedConfig& config,
                                const SceneSource& source, int frames);

}  // namespace retarget
