#include <cstddef>
#include <limits>

#include "human/skeleton/joint_clip.h"
#include "retarget/clip_arrays.h"

namespace retarget {

Result<Clip> clip_from_positions(const JointPositions& given) {
  constexpr std::size_t kMax = std::numeric_limits<int>::max();
  if (given.frames == 0 || given.joints == 0 || given.frames > kMax || given.joints > kMax) {
    return usage_failure("positions: expected frames and joints, found none or too many");
  }
  JointMotion motion;
  motion.rate = given.rate;
  motion.names = given.names;
  motion.frame_count = static_cast<int>(given.frames);
  motion.joint_count = static_cast<int>(given.joints);
  motion.positions.reserve(given.positions.size() / 3);
  for (std::size_t i = 0; i + 2 < given.positions.size(); i += 3) {
    motion.positions.emplace_back(given.positions[i], given.positions[i + 1],
                                  given.positions[i + 2]);
  }
  return clip_of_joints(motion, given.name);
}

}  // namespace retarget
