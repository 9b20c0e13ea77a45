#include "app/plan/human_in_world.h"

#include <array>

#include "retarget/appearance.h"
#include "retarget/normalize_start.h"
#include "retarget/plan.h"

namespace retarget {

HumanInWorld human_in_world(const Clip& clip, const Calibration& calibration) {
  HumanInWorld human;
  human.clip = &clip;
  human.metres_per_unit = calibration.metres_per_unit;
  human.world_from_clip.rotation = Eigen::Quaterniond(calibration.human_from_source).normalized();
  human.colours = joint_colours(clip.skeleton(), calibration);
  return human;
}

void normalize_start(RobotClip& clip, WriteMotionOptions& write) {
  if (clip.frame_count() == 0) return;
  if (!write.human) return normalize_start(clip);
  Pose& pose = write.human->world_from_clip;
  std::array<double, 7> place = {pose.translation.x(), pose.translation.y(), pose.translation.z(),
                                 pose.rotation.w(),    pose.rotation.x(),    pose.rotation.y(),
                                 pose.rotation.z()};
  StartNormalizer(clip.qpos(0)).apply(place);
  pose = {{place[3], place[4], place[5], place[6]}, {place[0], place[1], place[2]}};
  normalize_start(clip);
}

}  // namespace retarget
