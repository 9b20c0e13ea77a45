#pragma once

#include <functional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// Calibration of LAFAN1's skeleton as in the published method: file units are centimetres, Y is
/// up, and the body height is 1.75 m, independent of the bones. The synthetic feet are at the
/// ankles and turn with the toes.
/// @param joints   joints of the bones; -1: the bone is absent
/// @param turning  joints whose rotations turn the bones
[[nodiscard]] Calibration lafan1_calibration(const BoneArray<int>& joints,
                                             const BoneArray<int>& turning);

/// Computes the poses of a clip under a calibration one frame at a time, because the human poses of
/// a long clip need more memory than the clip. Keeps references to both arguments.
class HumanPoser {
 public:
  HumanPoser(const Clip& clip, const Calibration& calibration);

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

}  // namespace retarget
