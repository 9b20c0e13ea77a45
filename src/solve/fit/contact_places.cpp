#include "solve/fit/contact_places.h"

#include <algorithm>

#include "solve/fit/foot_plan.h"
#include "solve/fit/shorthand.h"

namespace retarget {

void ContactPlaces::resize() {
  sums_.resize(clip_.anchors.size());
  counts_.resize(clip_.anchors.size());
  pushes_.assign(clip_.anchors.size(), Eigen::Vector2d::Zero());
}

// The highest link index of the window's contacts. Ancestors have lower indices, so that forward
// kinematics up to this link suffices.
int ContactPlaces::last_link(const FitWindow& window) const {
  int last = 0;
  for (const PlantedPhase& phase : clip_.feet.phases) {
    if (!window.owns(phase)) continue;
    last = std::max(last, phase.support >= 0 ? model_.supports[at(phase.support)].link
                                             : model_.feet[at(phase.foot)].link);
  }
  return last;
}

void ContactPlaces::place(const FitWindow& window) {
  const int last = last_link(window);
  std::ranges::fill(counts_, 0);
  std::ranges::fill(sums_, Eigen::Vector2d::Zero());
  for (int frame = window.begin; frame < window.end; ++frame) {
    if (!clip_.feet.plants(frame)) continue;
    pose_.update_up_to(last, clip_.frame(frame, model_.configuration_size));
    clip_.feet.for_each_planted(frame, [&](int index, const Eigen::Vector2d& slide) {
      const PlantedPhase& phase = clip_.feet.phases[at(index)];
      if (!window.owns(phase)) return;
      sums_[at(index)] += planted_place(model_, phase, pose_) - slide;
      ++counts_[at(index)];
    });
  }
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (counts_[i] > 0) clip_.anchors[i] = sums_[i] / counts_[i] + pushes_[i];
  }
  std::ranges::fill(pushes_, Eigen::Vector2d::Zero());
}

void ContactPlaces::push_apart(const FitWindow& window, int frame, const FootOverlap& overlap) {
  if (overlap.depth <= 0.0) return;
  const auto ends = clip_.feet.ends_of(frame);
  const auto in_contact = [&](int foot) {
    return ends[at(2 * foot)].phase >= 0 || ends[at(2 * foot + 1)].phase >= 0;
  };
  if (!in_contact(overlap.foot_a) || !in_contact(overlap.foot_b)) return;
  const Eigen::Vector2d half = 0.5 * overlap.depth * overlap.normal;
  const auto push = [&](int foot, const Eigen::Vector2d& way) {
    for (int end = 2 * foot; end < 2 * foot + 2; ++end) {
      const int phase = ends[at(end)].phase;
      if (phase < 0 || !window.owns(clip_.feet.phases[at(phase)])) continue;
      Eigen::Vector2d& pushed = pushes_[at(phase)];
      if (way.squaredNorm() > pushed.squaredNorm()) pushed = way;
    }
  };
  push(overlap.foot_a, half);
  push(overlap.foot_b, -half);
}

}  // namespace retarget
