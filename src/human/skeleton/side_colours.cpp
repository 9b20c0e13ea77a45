#include "retarget/appearance.h"

namespace retarget {

int side_colour(Side side) {
  switch (side) {
    case Side::kLeft:
      return 0x5AA469;
    case Side::kRight:
      return 0xD0705F;
    default:
      return 0x8A8A8A;
  }
}

std::vector<int> joint_colours(const Skeleton& skeleton, const Calibration& calibration) {
  std::vector<int> colours(static_cast<std::size_t>(skeleton.joint_count()), -1);
  for (const Bone bone : kMappedBones) {
    const int joint = calibration.bones[bone].position_joint;
    if (joint >= 0) colours[static_cast<std::size_t>(joint)] = side_colour(side_of(bone));
  }
  for (std::size_t j = 0; j < colours.size(); ++j) {
    const int parent = skeleton.joint(static_cast<int>(j)).parent;
    if (colours[j] >= 0) continue;
    colours[j] = parent < 0 ? side_colour(Side::kNone) : colours[static_cast<std::size_t>(parent)];
  }
  return colours;
}

}  // namespace retarget
