#include "live/stream/human_bones.h"

#include <cmath>
#include <utility>

#include "retarget/human_poser.h"
#include "retarget/inspect.h"
#include "retarget/plan.h"
#include "retarget/so3.h"
#include "retarget/try.h"

namespace retarget {

Result<Clip> clip_of_human_bones(Clip clip, const HumanOptions& options,
                                 const std::string& data_folder) {
  RETARGET_TRY_ASSIGN(const HumanInClip found, find_human(clip, options, data_folder));
  return clip_of_human(clip, found.calibration);
}

BonePoses::BonePoses(const Clip& clip) {
  for (const Bone bone : kMappedBones) {
    joint_of_bone_[bone] = clip.skeleton().find(bone_name(bone)).value_or(-1);
  }
  world_from_joint_.resize(static_cast<std::size_t>(clip.skeleton().joint_count()));
  const Clip t_pose(clip.shared_skeleton(), clip.rate(), 1);
  forward_kinematics(t_pose, 0, world_from_joint_);
}

void BonePoses::set_frame(const Clip& clip, int frame) {
  forward_kinematics(clip, frame, world_from_joint_);
}

Pose with_z_ahead(const Pose& world_from_bone) {
  // For the T-pose that faces x, whose left is y.
  static const Eigen::Quaterniond bone_from_turned(0.5, 0.5, 0.5, 0.5);
  return {world_from_bone.rotation * bone_from_turned, world_from_bone.translation};
}

Pose in_y_up_world(const Pose& world_from_bone) {
  static const Eigen::Quaterniond y_up_from_z_up(std::sqrt(0.5), -std::sqrt(0.5), 0.0, 0.0);
  const Eigen::Vector3d& at = world_from_bone.translation;
  return {y_up_from_z_up * world_from_bone.rotation, {at.x(), at.z(), -at.y()}};
}

Pose mirrored_across_x(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& at = pose.translation;
  return {{q.w(), q.x(), -q.y(), -q.z()}, {-at.x(), at.y(), at.z()}};
}

Result<Clip> clip_with_units(Clip clip, const HumanOptions& options,
                             const std::string& data_folder) {
  ClipOrigin origin = clip.origin();
  if (origin.metres_per_unit && origin.up) return clip;
  // The search for the human may replace positions and rotations, but the clip is played unchanged.
  Clip looked_at = clip;
  Options as_run;
  as_run.human = options;
  RETARGET_TRY_ASSIGN(const HumanInClip found, find_human_as_run(looked_at, as_run, data_folder));
  if (!origin.metres_per_unit) origin.metres_per_unit = found.calibration.metres_per_unit;
  if (!origin.up) {
    origin.up = found.calibration.human_from_source.transpose() * Eigen::Vector3d::UnitZ();
  }
  clip.set_origin(std::move(origin));
  return clip;
}

ClipAxes::ClipAxes(const Clip& clip, const Eigen::Vector3d& up) {
  const ClipOrigin& origin = clip.origin();
  if (origin.up) turn_ = rotation_between(*origin.up, up);
  metres_per_unit_ = origin.metres_per_unit.value_or(1.0);
}

}  // namespace retarget
