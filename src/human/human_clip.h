#pragma once

#include <functional>
#include <string>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// The mapping of a skeleton with LAFAN1's joint names, as the published method takes it: file
/// units are centimetres, Y is up, the body 1.75 m high whatever its bones say. Further joints
/// (also above Hips) are allowed. Bones whose joints are not there are left out; a bone's name on
/// two joints is a kInput error.
/// @param file  where the skeleton comes from, for messages.
[[nodiscard]] Result<HumanMapping> lafan1_mapping(const Skeleton& skeleton,
                                                  const std::string& file);

/// The same for bones that were found by recognition, whatever their names.
[[nodiscard]] HumanMapping lafan1_mapping(const BoneMap& map);

/// Poses of a clip's frames under a mapping, one at a time: long clips need not be held as human
/// poses, which take more memory than what they come from. Refers to its clip and mapping.
class HumanPoser {
 public:
  HumanPoser(const Clip& clip, const HumanMapping& mapping);

  [[nodiscard]] HumanClipInfo info() const;

  void pose(int frame, HumanPose& world_from_bone);

 private:
  const Clip& clip_;
  const HumanMapping& mapping_;
  Eigen::Quaterniond turn_;
  std::vector<Pose> world_from_joint_;
};

/// Fills in a human's pose in a frame; most callers ask for 0, 1, 2, ...
using HumanPoseSource = std::function<void(int frame, HumanPose& world_from_bone)>;

/// The poses of a clip that outlives the source.
[[nodiscard]] HumanPoseSource poses_of(const HumanClip& human);

/// Poses of all frames under a mapping.
[[nodiscard]] HumanClip to_human(const Clip& clip, const HumanMapping& mapping);

}  // namespace retarget
