#include "human/gait/bridge_frames.h"

#include <utility>

#include "retarget/so3.h"

namespace retarget {
namespace {

// Share of the way from the frame before a gap to the frame after it.
double share_of_gap(FrameRange gap, int frame) {
  return (frame - gap.begin + 1.0) / (gap.end - gap.begin + 1.0);
}

}  // namespace

void bridge_rotations(Clip& clip, std::size_t joint, FrameRange gap) {
  const Eigen::Quaterniond before = std::as_const(clip).rotations(gap.begin - 1)[joint];
  const Eigen::Quaterniond after = std::as_const(clip).rotations(gap.end)[joint];
  const Eigen::Vector3d turn = log_so3(before.conjugate() * after);
  for (int frame = gap.begin; frame < gap.end; ++frame) {
    clip.rotations(frame)[joint] = before * exp_so3(share_of_gap(gap, frame) * turn);
  }
}

void bridge_translations(Clip& clip, std::size_t slot, FrameRange gap) {
  const Eigen::Vector3d before = std::as_const(clip).translations(gap.begin - 1)[slot];
  const Eigen::Vector3d after = std::as_const(clip).translations(gap.end)[slot];
  for (int frame = gap.begin; frame < gap.end; ++frame) {
    clip.translations(frame)[slot] = before + share_of_gap(gap, frame) * (after - before);
  }
}

void bridge_body(Clip& clip, FrameRange gap) {
  const auto joints = static_cast<std::size_t>(clip.skeleton().joint_count());
  for (std::size_t joint = 0; joint < joints; ++joint) bridge_rotations(clip, joint, gap);
  const std::size_t slots = std::as_const(clip).translations(gap.begin).size();
  for (std::size_t slot = 0; slot < slots; ++slot) {
    bool still = true;
    for (int frame = gap.begin + 1; frame < gap.end; ++frame) {
      still = still && std::as_const(clip).translations(frame)[slot] ==
                           std::as_const(clip).translations(gap.begin)[slot];
    }
    if (still) bridge_translations(clip, slot, gap);
  }
}

}  // namespace retarget
