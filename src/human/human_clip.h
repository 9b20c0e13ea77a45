#pragma once

#include <functional>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// The calibration of LAFAN1's skeleton as the published method takes it: file units are centimetres, Y
/// is up, the body 1.75 m high whatever its bones say. The synthetic feet stand at the ankles and turn
/// with the toes.
/// @param joints   of the bones; -1: the bone is left out.
/// @param turning  the joints whose rotations turn them.
[[nodiscard]] Calibration lafan1_calibration(const BoneArray<int>& joints,
                                             const BoneArray<int>& turning);

/// Poses of a clip's frames under a calibration, one at a time: long clips need not be held as human
/// poses, which take more memory than what they come from. Refers to its clip and calibration.
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

/// Fills in a human's pose in a frame; most callers ask for 0, 1, 2, ...
using HumanPoseSource = std::function<void(int frame, HumanPose& world_from_bone)>;

/// The poses of a clip that outlives the source.
[[nodiscard]] HumanPoseSource poses_of(const HumanClip& human);

/// The poses that a poser makes, which outlives the source.
[[nodiscard]] HumanPoseSource poses_of(HumanPoser& poser);

/// Poses of all frames under a calibration.
[[nodiscard]] HumanClip to_human(const Clip& clip, const Calibration& calibration);

}  // namespace retarget
