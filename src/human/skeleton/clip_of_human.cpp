#include <utility>

#include "human/skeleton/robot_human.h"
#include "retarget/human_poser.h"

namespace retarget {

Result<Clip> clip_of_human(const Clip& clip, const Calibration& calibration) {
  if (clip.frame_count() == 0) return input_failure(clip.name(), "the clip has no frames");
  HumanPoser poser(clip, calibration);
  const HumanClipInfo info = poser.info();
  // Reuse the conversion from a robot's motion to a human clip.
  RobotHuman human;
  human.rate = clip.rate();
  human.frame_count = clip.frame_count();
  human.poses = poses_of(poser);
  for (const Bone bone : kMappedBones) human.has[bone] = info.has(bone);
  poser.pose(0, human.standing);
  Clip bones = clip_of_robot_human(human, clip.name());
  ClipOrigin origin = bones.origin();
  origin.body_height = calibration.height;
  bones.set_origin(std::move(origin));
  return bones;
}

}  // namespace retarget
