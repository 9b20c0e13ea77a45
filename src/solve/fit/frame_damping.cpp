#include "solve/fit/frame_damping.h"

#include <algorithm>
#include <limits>

#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

constexpr std::size_t kPosition = 3;  // The first degrees of freedom are the root's position.
// Constant damping: joints and root rotation; root position.
constexpr double kDamping = 1.0, kPositionDamping = 100.0;
// With a faster decay, frames oscillate between two states.
constexpr double kStart = 0.02, kGrowth = 4.0, kDecay = 0.7, kMost = 2.0, kLeast = 1e-3;
constexpr double kCostRise = 1.02, kCostNoise = 0.1;
// The largest curvature to which a factor refers: approximately that of the tracking terms, per
// rad^2 and, for the G1's legs, per m^2. The curvature of contacts is up to a thousand times as
// large. Damping in proportion to it would also stop the movements that keep the contacts, such as
// a crouch.
constexpr double kAngleCurvature = 1000.0, kLengthCurvature = 10000.0;

}  // namespace

FrameDamping::FrameDamping(const FitModel& model, std::size_t frames, bool slides)
    : state_{std::vector<double>(frames, 0.0), std::vector<double>(frames, 1e300)},
      largest_(at(model.dof_count()), kAngleCurvature) {
  if (slides) {
    std::ranges::fill(largest_, std::numeric_limits<double>::infinity());
    return;
  }
  const double of_lengths = kLengthCurvature * square(kUsualLeg / model.leg);
  std::fill_n(largest_.begin(), kPosition, of_lengths);
  for (std::size_t link = 1; link < model.tree.links().size(); ++link) {
    if (!model.tree.links()[link].slides) continue;
    largest_[at(KinematicTree::dof_of(static_cast<int>(link)))] = of_lengths;
  }
}

void FrameDamping::adapt(std::size_t frame, double cost) {
  double& factor = state_.factors[frame];
  if (cost > kCostRise * state_.costs[frame] + kCostNoise) {
    factor = std::min(kMost, std::max(factor, kStart) * kGrowth);
  } else {
    factor = factor < kLeast ? 0.0 : factor * kDecay;
  }
  state_.costs[frame] = cost;
}

void FrameDamping::maximise(std::size_t frame) {
  state_.factors[frame] = kMost;
}

double FrameDamping::of(std::size_t frame, std::size_t dof, double diagonal) const {
  const double constant = dof < kPosition ? kPositionDamping : kDamping;
  return constant + state_.factors[frame] * std::min(diagonal, largest_[dof]);
}

void FrameDamping::move(std::size_t dropped, std::size_t frames) {
  const auto take = [&](std::vector<double>& values, double value) {
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(dropped));
    values.resize(frames, value);
  };
  take(state_.factors, 0.0);
  take(state_.costs, 1e300);
}

}  // namespace retarget
