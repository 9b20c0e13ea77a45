#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace RETARGET_API retarget {

/// Computes the poses of a clip under a calibration one frame at a time, because the human poses of
/// a long clip need more memory than the clip. Keeps references to both arguments.
class HumanPoser {
 public:
  HumanPoser(const Clip& clip, const Calibration& calibration);
  HumanPoser(const Clip&& clip, const Calibration& calibration) = delete;
  HumanPoser(const Clip& clip, const Calibration&& calibration) = delete;
  HumanPoser(const Clip&& clip, const Calibration&& calibration) = delete;

  [[nodiscard]] HumanClipInfo info() const;

  void pose(int frame, HumanPose& world_from_bone);

 private:
  const Clip& clip_;
  const Calibration& calibration_;
  Eigen::Quaterniond turn_;
  std::vector<Pose> world_from_joint_;
};

/// Fills in the human's pose of a frame. Most callers request frames 0, 1, 2, ...
using HumanPoseSource = std::function<void(int frame, HumanPose& world_from_bone)>;

/// Poses of a human clip, which must outlive the source.
[[nodiscard]] HumanPoseSource poses_of(const HumanClip& human);

/// Poses from a poser, which must outlive the source.
[[nodiscard]] HumanPoseSource poses_of(HumanPoser& poser);

/// Converts the human in a clip to a separate clip: one joint per recognised bone, with the bone's
/// name (bone_name), in metres, Z up.
///
/// The zero pose is the T-pose that faces x, in which all joints have the world's axes. Bones that
/// are not rigidly attached, such as those of a spine with omitted joints, have translations. The
/// origin contains the body height. kInput errors: a clip without frames.
[[nodiscard]] Result<Clip> clip_of_human(const Clip& clip, const Calibration& calibration);

}  // namespace retarget
