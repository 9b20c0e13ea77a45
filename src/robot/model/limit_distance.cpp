#include "robot/model/limit_distance.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace retarget {
namespace {

// Marks the joints that leave the zero configuration in at least one frame.
std::vector<bool> moving_joints(const RobotClip& clip) {
  const std::vector<double> zero = clip.robot().zero_configuration();
  std::vector<bool> moves;
  for (const RobotJoint& joint : clip.robot().joints()) {
    bool any = false;
    for (int frame = 0; frame < clip.frame_count() && !any; ++frame) {
      any = clip.qpos(frame)[joint.qpos_address] != zero[joint.qpos_address];
    }
    moves.push_back(any);
  }
  return moves;
}

}  // namespace

std::optional<LimitDistance> nearest_limit(const RobotClip& clip, const LimitSet& limits) {
  LimitDistance nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  const std::vector<bool> moves = moving_joints(clip);
  int frames_at_limit = 0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    bool at_limit = false;
    for (std::size_t j = 0; j < clip.robot().joints().size(); ++j) {
      if (!moves[j] || limits.lower[j] == limits.upper[j]) continue;
      const RobotJoint& joint = clip.robot().joints()[j];
      const double q = clip.qpos(frame)[joint.qpos_address];
      const double from_lower = q - limits.lower[j];
      const double from_upper = limits.upper[j] - q;
      const double distance = std::min(from_lower, from_upper);
      at_limit = at_limit || distance <= kAtLimit;
      if (distance < nearest.distance) {
        nearest.joint = joint.name;
        nearest.frame = frame;
        nearest.at_upper = from_upper < from_lower;
        nearest.distance = distance;
      }
    }
    if (at_limit) ++frames_at_limit;
  }
  if (nearest.joint.empty()) return std::nullopt;
  nearest.frames_at_limit = static_cast<double>(frames_at_limit) / clip.frame_count();
  return nearest;
}

}  // namespace retarget
