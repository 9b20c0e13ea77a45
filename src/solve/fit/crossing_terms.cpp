#include "solve/fit/crossing_terms.h"

#include <algorithm>
#include <iterator>

#include "solve/fit/shorthand.h"

namespace retarget {

CrossingTerms::CrossingTerms(const FitModel& model, const FitClip& clip, const FitWindow& window)
    : model_(model),
      clip_(clip),
      window_(window),
      half_way_(model),
      crossings_(at(window.end - window.begin)) {}

void CrossingTerms::find(int frame, const PoseWithPairs& before, const PoseWithPairs& now) {
  constexpr double kNearlyOverlap = 0.02;  // Metres.
  std::vector<std::uint32_t>& found = crossings_to(frame);
  candidates_.clear();
  std::ranges::set_union(before.pairs, now.pairs, std::back_inserter(candidates_));
  for (const std::uint32_t pair : candidates_) {
    if (std::ranges::find(found, pair) != found.end()) continue;
    if (!may_cross(model_, before.pose, now.pose, pair)) continue;
    pose_half_way(frame);
    if (pair_distance(model_, half_way_.pose(), pair) < kNearlyOverlap) found.push_back(pair);
  }
}

void CrossingTerms::add(int frame, FrameTerms& terms, double* g, double* h, int stride,
                        TermCosts& costs) {
  for (const int later : {frame, frame + 1}) {
    if (later >= window_.end || crossings_to(later).empty()) continue;
    pose_half_way(later);
    terms.add_crossings(half_way_.pose(), crossings_to(later), g, h, stride, costs);
  }
}

// Computes the pose half-way from the frame before; once in every step of the solver.
void CrossingTerms::pose_half_way(int frame) {
  if (half_way_to_ == frame) return;
  half_way_.update(clip_.frame(frame - 1, model_.configuration_size),
                   clip_.frame(frame, model_.configuration_size));
  half_way_to_ = frame;
}

std::vector<std::uint32_t>& CrossingTerms::crossings_to(int frame) {
  return crossings_[at(frame - window_.begin)];
}

}  // namespace retarget
