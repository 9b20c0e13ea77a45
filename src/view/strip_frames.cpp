#include "view/strip_frames.h"

#include <algorithm>
#include <cstdint>

namespace retarget {

std::vector<int> spread_frames(int frame_count, int poses) {
  const int count = std::clamp(poses, 1, frame_count);
  std::vector<int> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(count == 1 ? 0
                                : static_cast<int>(static_cast<std::int64_t>(frame_count - 1) * i /
                                                   (count - 1)));
  }
  return frames;
}

Eigen::Vector3d facing(const RobotClip& motion, const std::vector<int>& frames) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int frame : frames) {
    const auto q = motion.qpos(frame);
    sum += Eigen::Quaterniond(q[3], q[4], q[5], q[6]).normalized() * Eigen::Vector3d::UnitX();
  }
  return sum;
}

RowHeights row_heights(const Eigen::AlignedBox2d& figures, double body) {
  const double low = figures.min().y(), high = figures.max().y();
  if (low > body || high < -body) return {low, high, false};
  return {std::min(0.0, low), std::max(0.0, high), true};
}

}  // namespace retarget
