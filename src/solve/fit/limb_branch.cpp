#include "solve/fit/limb_branch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "retarget/spline.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

constexpr int kSeeds = 24;  // Number of start configurations of a search.
// Share of stuck_cost() that another configuration must not exceed.
constexpr double kBetter = 0.5;
// Largest joint speed in a change of branches, rad/s.
constexpr double kBlendingSpeed = 7.0;
constexpr double kMeet = 0.02;      // Largest joint difference of equal branches, rad.
constexpr double kLookAhead = 3.0;  // Search range beyond the best end of a branch, seconds.
constexpr double kEndsEvery = 0.1;  // Interval between candidate ends of a branch, seconds.

// The i-th element of the van der Corput sequence in base `base`, in [0, 1). One prime base per
// joint gives a Halton sequence of start configurations.
double van_der_corput(int i, int base) {
  double number = 0.0, digit = 1.0;
  for (; i > 0; i /= base) {
    digit /= base;
    number += digit * (i % base);
  }
  return number;
}

// Blending weight of the other branch in frame `index` of a path that leaves it after `frames`
// frames.
double share_of_other(int index, int frames, int blended) {
  if (blended == 0) return index < frames ? 1.0 : 0.0;
  return 1.0 - smooth_step(0.0, 2.0 * blended, index - (frames - blended) + 0.5);
}

}  // namespace

void put_limb(const FitModel& model, const FitLimb& limb, const LimbBranch& branch, FitClip& clip) {
  for (int t = branch.begin; t < branch.end; ++t) {
    const auto frame = clip.frame(t, model.configuration_size);
    for (std::size_t i = 0; i < limb.links.size(); ++i) {
      joint_value(model, limb.links[i], frame) = branch.joints[at(t - branch.begin)][i];
    }
  }
}

BranchFinder::BranchFinder(const FitModel& model, const FitOptions& options, const FitClip& clip,
                           const FitLimb& limb)
    : model_(model),
      options_(options),
      clip_(clip),
      limb_(limb),
      frame_(model, clip, limb),
      terms_(model, options),
      gradient_(at(model.dof_count())),
      hessian_(gradient_.size() * gradient_.size()) {}

// Cost of all terms that depend on a single frame.
double BranchFinder::frame_cost() {
  TermCosts costs{};
  if (options_.self_collision) {
    terms_.find_near_pairs(frame_.pose(), options_.self_collision_margin + kOverlapBand, pairs_);
  }
  terms_.assemble(frame_.pose(), frame_.goals(), pairs_, gradient_.data(), hessian_.data(),
                  model_.dof_count(), costs);
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

double BranchFinder::farthest(const LimbJoints& a, const LimbJoints& b) const {
  double most = 0.0;
  for (std::size_t i = 0; i < count(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

double BranchFinder::cost(int frame) {
  frame_.set(frame);
  return frame_.cost();
}

double BranchFinder::stuck_cost(int frame) {
  frame_.set(frame);
  return frame_.solve(frame_.limits());
}

std::optional<LimbJoints> BranchFinder::other_configuration(int frame, double least) {
  constexpr std::array kPrimes = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  static_assert(kPrimes.size() == kMaxLimbJoints);
  constexpr double kTurn = std::numbers::pi;  // Search range of joints without limits, rad.
  const LimbRange& limits = frame_.limits();
  const double stuck = stuck_cost(frame);
  double min = std::min(kBetter * stuck, stuck - least);
  // The negated comparison also rejects NaN.
  if (!(min > 0.0)) return std::nullopt;
  std::optional<LimbJoints> best;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    LimbJoints joints{};
    for (std::size_t i = 0; i < count(); ++i) {
      const double lower = std::max(limits.lower[i], -kTurn);
      const double upper = std::max(lower, std::min(limits.upper[i], kTurn));
      const double share = van_der_corput(seed, kPrimes[i]);
      joints[i] = lower + (limb_.reversed[i] ? 1.0 - share : share) * (upper - lower);
    }
    frame_.place(joints);
    const double left = frame_.solve(limits);
    if (!(left < min)) continue;
    constexpr double kClearlyBetter = 0.95;
    min = kClearlyBetter * left;
    best = frame_.joints();
  }
  return best;
}

// Follows the branch from `frame` until the branches meet or no further gain is likely.
std::vector<BranchFinder::Step> BranchFinder::steps(int frame, int direction,
                                                    const LimbJoints& joints) {
  constexpr double kMaxSpeed = 10.0;  // Radians per second.
  const int look_ahead = static_cast<int>(kLookAhead / clip_.frame_time) + 1;
  std::vector<Step> steps;
  LimbJoints last = joints;
  double gain = 0.0, best_gain = 0.0;
  // Tolerated loss after the best gain: the cost of one second of frames like the first one.
  double max_loss = 0.0;
  int best = 0;
  for (int t = frame; t >= 0 && t < clip_.frame_count; t += direction) {
    const auto index = static_cast<int>(steps.size());
    if (index > best + look_ahead) break;
    Step step;
    frame_.set(t);
    step.own = frame_.joints();
    step.own_cost = frame_cost();
    frame_.place(last);
    frame_.solve(frame_.within_reach(last, kMaxSpeed * clip_.frame_time));
    step.other = frame_.joints();
    step.other_cost = frame_cost();
    steps.push_back(step);
    if (index == 0) max_loss = std::max(0.0, step.own_cost) / clip_.frame_time;
    last = step.other;
    if (farthest(step.other, step.own) < kMeet) break;
    gain += step.own_cost - step.other_cost;
    if (gain > best_gain) {
      best_gain = gain;
      best = index;
    } else if (best_gain - gain > best_gain + max_loss) {
      break;
    }
  }
  return steps;
}

LimbJoints BranchFinder::blended(const Step& step, double share) const {
  LimbJoints joints{};
  for (std::size_t i = 0; i < count(); ++i) {
    joints[i] = step.own[i] + share * (step.other[i] - step.own[i]);
  }
  return joints;
}

// Additional cost of the blended frames, compared with a jump between the branches.
double BranchFinder::blending_cost(int frame, int direction, const std::vector<Step>& steps,
                                   const Reach& reach) {
  double cost = 0.0;
  for (int i = reach.frames - reach.blended; i < reach.frames + reach.blended; ++i) {
    const Step& step = steps[at(i)];
    frame_.set(frame + direction * i);
    frame_.place(blended(step, share_of_other(i, reach.frames, reach.blended)));
    cost += frame_cost() - (i < reach.frames ? step.other_cost : step.own_cost);
  }
  return cost;
}

BranchFinder::Reach BranchFinder::best_reach(int frame, int direction,
                                             const std::vector<Step>& steps) {
  const auto size = static_cast<int>(steps.size());
  const int every = std::max(1, static_cast<int>(std::lround(kEndsEvery / clip_.frame_time)));
  Reach best{0, 0, -1e300};
  // Share of the best gain that a branch up to the end of the clip must have. A smaller gain would
  // only come from avoiding the cost of changing back.
  constexpr double kKept = 0.5;
  double gain = 0.0, most = 0.0;
  for (int frames = 1; frames <= size; ++frames) {
    const Step& step = steps[at(frames) - 1];
    gain += step.own_cost - step.other_cost;
    most = std::max(most, gain);
    const int last = frame + direction * (frames - 1);
    const bool clip_ends = last == (direction > 0 ? clip_.frame_count - 1 : 0);
    if (gain <= best.gain) continue;
    if (clip_ends) {
      if (gain >= kKept * most) best = {frames, 0, gain};
      continue;
    }
    if (frames % every != 0 && frames < size) continue;
    Reach reach{frames, 0, gain};
    constexpr double kSteepest = 0.75;  // Half of the largest slope of smooth_step().
    const double turn = farthest(step.own, step.other);
    if (turn >= kMeet) {
      reach.blended =
          static_cast<int>(std::ceil(kSteepest * turn / (kBlendingSpeed * clip_.frame_time)));
    }
    if (frames < reach.blended || frames + reach.blended > size) continue;
    reach.gain -= blending_cost(frame, direction, steps, reach);
    if (reach.gain > best.gain) best = reach;
  }
  return best;
}

std::optional<LimbBranch> BranchFinder::follow(int frame, const LimbJoints& joints) {
  const std::vector<Step> after = steps(frame, 1, joints);
  const std::vector<Step> before = steps(frame, -1, joints);
  if (after.empty() || before.empty()) return std::nullopt;
  const Reach on = best_reach(frame, 1, after), back = best_reach(frame, -1, before);
  const double twice = after.front().own_cost - after.front().other_cost;
  if (on.frames == 0 || back.frames == 0 || on.gain + back.gain - twice <= 0.0) return std::nullopt;
  LimbBranch branch;
  branch.begin = frame - (back.frames + back.blended - 1);
  branch.end = frame + on.frames + on.blended;
  for (int t = branch.begin; t < branch.end; ++t) {
    const bool late = t >= frame;
    const Reach& reach = late ? on : back;
    const int index = late ? t - frame : frame - t;
    branch.joints.push_back(blended((late ? after : before)[at(index)],
                                    share_of_other(index, reach.frames, reach.blended)));
  }
  return branch;
}

}  // namespace retarget
