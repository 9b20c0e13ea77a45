#include "solve/fit/limb_frame.h"

#include <algorithm>

#include "solve/fit/shorthand.h"

namespace retarget {

LimbFrame::LimbFrame(const FitModel& model, const FitClip& clip, const FitLimb& limb)
    : model_(model),
      clip_(clip),
      limb_(limb),
      solver_(model, limb),
      pose_(model.tree),
      qpos_(at(model.configuration_size)) {}

void LimbFrame::set(int frame) {
  frame_ = frame;
  std::ranges::copy(clip_.frame(frame, model_.configuration_size), qpos_.begin());
  pose_.update(qpos_);
}

void LimbFrame::place(const LimbJoints& joints) {
  for (std::size_t i = 0; i < limb_.links.size(); ++i) {
    joint_value(model_, limb_.links[i], qpos_) = joints[i];
  }
  pose_.update_subtree(limb_.link, qpos_);
}

double LimbFrame::solve(const LimbRange& range) {
  return solver_.solve(goals(), range, pose_, qpos_);
}

LimbJoints LimbFrame::joints() const {
  LimbJoints joints{};
  for (std::size_t i = 0; i < limb_.links.size(); ++i) {
    joints[i] = qpos_[at(model_.tree.links()[at(limb_.links[i])].qpos_address)];
  }
  return joints;
}

LimbRange LimbFrame::within_reach(const LimbJoints& joints, double step) const {
  LimbRange range = limits();
  for (std::size_t i = 0; i < limb_.links.size(); ++i) {
    range.lower[i] = std::max(range.lower[i], joints[i] - step);
    range.upper[i] = std::min(range.upper[i], joints[i] + step);
  }
  return range;
}

}  // namespace retarget
