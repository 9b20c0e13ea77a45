#include "solve/fit/window_steps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kBase = KinematicTree::kBaseDofs;

// Largest change of a variable per step: joints and root rotation (rad), root position (m).
constexpr double kMaxTurn = 0.15, kMaxMove = 0.2;
constexpr double kPairsWithin = 0.04;  // Metres.
// Near pairs of a frame of a stream for which there is room; more of them allocate.
constexpr std::size_t kUsualPairs = 256;
// Initial share of the anchor weight. An anchor is the mean position of the foot end that it holds,
// so at full weight neither would move.
constexpr double kFirstHold = 0.12;

}  // namespace

WindowSteps::WindowSteps(const FitModel& model, const FitOptions& options, const FitWindow& window,
                         FitClip& clip)
    : model_(model),
      options_(options),
      window_(window),
      clip_(clip),
      dofs_(model.dof_count()),
      before_(window.fixed_ends && window.begin > 0),
      after_(window.fixed_ends && window.end < clip.frame_count),
      terms_(model, options),
      pose_(model.tree),
      pose_before_(model.tree),
      speeds_(model, options, clip, window.begin < window.end),
      chain_(dofs_),
      pairs_(at(window.end - window.begin)),
      pairs_stay_(
          std::max(0.0, 0.5 * (kPairsWithin - options.self_collision_margin - kOverlapBand))),
      damping_(model, pairs_.size(), window.begin == window.end),
      held_(model, pairs_.size()),
      steps_before_(at(dofs_)),
      steps_after_(at(dofs_)),
      applied_(at(dofs_)),
      given_(at(model.configuration_size)),
      places_(model, clip) {
  for (int i = kBase; i < dofs_; ++i) {
    given_[at(model.tree.links()[at(i - kBase + 1)].qpos_address)] = model.lower[at(i)];
  }
  if (window.between_frames) crossings_.emplace(model, clip, window_);
}

double WindowSteps::hold_after(int steps) const {
  const double left = options_.anchor_iterations - steps;
  return left <= 0.0 ? 1.0 : 1.0 - (1.0 - kFirstHold) * left / options_.anchor_iterations;
}

WindowSteps::State WindowSteps::state() const {
  const auto size = at(model_.configuration_size);
  const auto begin = clip_.qpos.begin() + static_cast<std::ptrdiff_t>(at(window_.begin) * size);
  const auto end = clip_.qpos.begin() + static_cast<std::ptrdiff_t>(at(window_.end) * size);
  State state{{begin, end}, {}, damping_.state(), held_.sides(), places_.pushes(), pairs_};
  // A concurrent window may be writing the other anchors.
  for (std::size_t i = 0; i < clip_.anchors.size(); ++i) {
    if (owns(i)) state.anchors.push_back(clip_.anchors[i]);
  }
  return state;
}

void WindowSteps::restore(const State& state) {
  const auto size = at(model_.configuration_size);
  std::ranges::copy(state.qpos,
                    clip_.qpos.begin() + static_cast<std::ptrdiff_t>(at(window_.begin) * size));
  auto anchor = state.anchors.begin();
  for (std::size_t i = 0; i < clip_.anchors.size(); ++i) {
    if (owns(i)) clip_.anchors[i] = *anchor++;
  }
  damping_.set_state(state.damping);
  held_.set_sides(state.held);
  places_.set_pushes(state.anchor_pushes);
  pairs_ = state.pairs;
}

void WindowSteps::take(const Kind& kind, FitStatus& status) {
  const int first = std::max(window_.begin - (before_ ? 1 + window_.context : 0), 0);
  const int last = std::min(window_.end + (after_ ? 1 + window_.context : 0), clip_.frame_count);
  speeds_.update(model_, clip_, first, last);
  chain_.begin(window_.end - window_.begin);
  held_.begin_step();
  if (crossings_) crossings_->begin_step();
  if (before_) speeds_.terms(window_.begin - 1, steps_after_);
  const auto decrease = eliminate(kind, status);
  status.predicted_decrease = decrease.value_or(1.0);
  if (!decrease) return;
  chain_.substitute();
  if (!has_finite_solution()) {
    status.failed = true;
    status.predicted_decrease = 1.0;
    return;
  }
  ++status.steps;
  held_.release(chain_);
  for (int frame = window_.begin; frame < window_.end; ++frame) apply(frame, kind.dynamics);
}

// Assembles and factorises the blocks of all frames.
// @return the predicted cost decrease as a share of the cost. Empty if a block is not positive
//     definite; its frame then gets the maximum damping in the next step.
std::optional<double> WindowSteps::eliminate(const Kind& kind, FitStatus& status) {
  double cost = 0.0, decrease = 0.0;
  worst_overlap_ = 0.0;
  for (int frame = window_.begin; frame < window_.end; ++frame) {
    const int t = local(frame);
    cost += fill_frame(frame, kind);
    const bool finite = is_finite(t, cost);
    status.failed = status.failed || !finite;
    const bool positive = finite && chain_.eliminate(t);
    // Sums b' H^-1 b over the blocks, from the reduced right-hand sides and partial solutions.
    for (int i = 0; positive && i < dofs_; ++i) {
      decrease += chain_.right(t)[i] * chain_.solution(t)[at(i)];
    }
    if (positive && std::isfinite(decrease)) continue;
    ++status.failed_blocks;
    damping_.maximise(at(t));
    return std::nullopt;
  }
  return cost > 0.0 ? decrease / cost : 0.0;
}

// Computes the pose of a frame, and finds its near pairs and crossings if they are due.
void WindowSteps::place_frame(int frame, bool look_for_pairs) {
  const int t = local(frame);
  const bool look_between = crossings_ && look_for_pairs;
  if (look_between) std::swap(pose_, pose_before_);
  pose_.update(clip_.frame(frame, model_.configuration_size));
  const bool pairs_are_due = ages_.empty() ? look_for_pairs : ages_[at(t)] % kPairsEvery == 0;
  if (options_.self_collision && pairs_are_due) {
    terms_.update_near_pairs(pose_, kPairsWithin, pairs_stay_, pairs_[at(t)]);
  }
  if (look_between && t > 0) {
    crossings_->find(frame, {pose_before_, pairs_[at(t) - 1].pairs}, {pose_, pairs_[at(t)].pairs});
  }
}

// Assembles the block of a frame.
// @return the frame's cost, including that of the step to the next frame.
double WindowSteps::fill_frame(int frame, const Kind& kind) {
  const int t = local(frame);
  place_frame(frame, kind.look_for_pairs);
  double* const h = chain_.block(t);
  double* const g = chain_.right(t);
  TermCosts costs{};
  FrameGoals goals = clip_.goals(frame, model_.tasks.size());
  goals.anchor_hold = ages_.empty() ? kind.anchor_hold : hold_after(ages_[at(t)]);
  terms_.assemble(pose_, goals, pairs_[at(t)].pairs, g, h, chain_.stride(), costs);
  add_limit_margins(model_, options_, clip_.frame(frame, model_.configuration_size), g, h,
                    chain_.stride(), costs);
  worst_overlap_ =
      std::max(worst_overlap_, costs[kTermSelfCollision] / square(options_.self_collision_weight));
  if (kind.move_anchors) places_.push_apart(window_, frame, terms_.foot_overlap());
  if (crossings_) crossings_->add(frame, terms_, g, h, chain_.stride(), costs);
  // Damping depends on the cost without the anchor term: anchors and their weight change between
  // steps, so their cost does not show whether the step was too long.
  double cost = -costs[kTermContactPlace];
  for (const double part : costs) cost += part;
  // With dynamics, frames may leave their targets so that contacts can supply the forces. That
  // does not show that the step was too long either.
  if (kind.dynamics != nullptr) cost -= costs[kTermPosition] + costs[kTermRotation];
  damping_.adapt(at(t), cost);
  for (int i = 0; i < dofs_; ++i) {
    double& diagonal = h[static_cast<std::ptrdiff_t>(i) * (chain_.stride() + 1)];
    diagonal += damping_.of(at(t), at(i), diagonal);
  }
  // Added after the damping, because the goals of the dynamics rows change in every step.
  double dynamics_cost = 0.0;
  if (kind.dynamics != nullptr) {
    dynamics_cost = kind.dynamics->add_rows(frame, pose_, g, h, chain_.stride());
  }
  add_steps(frame, h, g);
  const std::span<const StepTerm> none;
  held_.hold(t, h, g, chain_.stride(), chain_.coupling(t),
             frame > window_.begin ? std::span<const StepTerm>(steps_before_) : none,
             frame + 1 < window_.end ? std::span<const StepTerm>(steps_after_) : none);
  for (int i = 0; i < dofs_; ++i) g[i] = -g[i];
  if (frame + 1 < window_.end || after_) speeds_.add_costs(frame, costs);
  return std::accumulate(costs.begin(), costs.end(), dynamics_cost);
}

// Checks a frame's cost, gradient and Hessian diagonal. The diagonal suffices: its entries are sums
// of squares, which are not finite if an entry of the row is not.
bool WindowSteps::is_finite(int t, double cost) {
  const double* const h = chain_.block(t);
  const double* const g = chain_.right(t);
  bool finite = std::isfinite(cost);
  for (int i = 0; i < dofs_; ++i) {
    const double diagonal = h[static_cast<std::ptrdiff_t>(i) * (chain_.stride() + 1)];
    finite = finite && std::isfinite(g[i]) && std::isfinite(diagonal);
  }
  return finite;
}

bool WindowSteps::has_finite_solution() const {
  for (int frame = window_.begin; frame < window_.end; ++frame) {
    const auto x = chain_.solution(local(frame));
    if (!std::ranges::all_of(x, [](double value) { return std::isfinite(value); })) return false;
  }
  return true;
}

// Adds the terms of the step to this frame and of the step from it.
void WindowSteps::add_steps(int frame, double* h, double* g) {
  std::swap(steps_before_, steps_after_);
  const bool from = frame > window_.begin || before_;
  const bool to = frame + 1 < window_.end || after_;
  if (to) speeds_.terms(frame, steps_after_);
  double* const coupling = chain_.coupling(local(frame));
  for (int i = 0; i < dofs_; ++i) {
    double& diagonal = h[static_cast<std::ptrdiff_t>(i) * (chain_.stride() + 1)];
    if (from) {
      diagonal += steps_before_[at(i)].weight;
      g[i] += steps_before_[at(i)].force;
    }
    if (to) {
      diagonal += steps_after_[at(i)].weight;
      g[i] -= steps_after_[at(i)].force;
    }
    if (frame > window_.begin) coupling[i] = -steps_before_[at(i)].weight;
  }
}

void WindowSteps::move_base(std::span<const double> x, std::span<double> qpos) {
  for (int k = 0; k < 3; ++k) {
    applied_[at(k)] = std::clamp(x[at(k)], -kMaxMove, kMaxMove);
    qpos[at(k)] += applied_[at(k)];
  }
  Vector3d turn(x[3], x[4], x[5]);
  const double angle = turn.norm();
  if (angle > kMaxTurn) turn *= kMaxTurn / angle;
  for (int k = 0; k < 3; ++k) applied_[at(3 + k)] = turn[k];
  const Quaterniond rotation =
      (Quaterniond(qpos[3], qpos[4], qpos[5], qpos[6]) * exp_so3(turn)).normalized();
  qpos[3] = rotation.w();
  qpos[4] = rotation.x();
  qpos[5] = rotation.y();
  qpos[6] = rotation.z();
}

void WindowSteps::apply(int frame, FitDynamics* dynamics) {
  const auto x = chain_.solution(local(frame));
  const auto qpos = clip_.frame(frame, model_.configuration_size);
  if (!model_.base_is_held) move_base(x, qpos);
  if (clip_.hold) clip_.hold(frame, given_);
  for (int i = kBase; i < dofs_; ++i) {
    applied_[at(i)] = 0.0;
    if (held_.is_held(local(frame), i)) continue;
    const std::size_t address = at(model_.tree.links()[at(i - kBase + 1)].qpos_address);
    double& value = qpos[address];
    const double before = value;
    value += std::clamp(x[at(i)], -kMaxTurn, kMaxTurn);
    held_.clamp(local(frame), i, value);
    const bool is_given = clip_.hold && model_.lower[at(i)] == model_.upper[at(i)];
    if (is_given) value = given_[address];
    applied_[at(i)] = value - before;
  }
  if (dynamics != nullptr) dynamics->moved(frame, applied_);
}

void WindowSteps::move(int begin, int forgotten) {
  const auto gone = std::min(at(begin + forgotten - window_.begin), pairs_.size());
  const std::size_t kept = pairs_.size() - gone, size = at(clip_.frame_count - begin);
  window_.begin = begin;
  window_.end = clip_.frame_count;
  before_ = begin > 0;
  damping_.move(gone, size);
  held_.move(gone, size);
  ages_.erase(ages_.begin(), ages_.begin() + static_cast<std::ptrdiff_t>(gone));
  ages_.resize(size, 0);
  // Rotating instead of erasing keeps the lists' memory.
  std::rotate(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(gone), pairs_.end());
  pairs_.resize(size);
  for (std::size_t i = kept; i < size; ++i) {
    pairs_[i].forget();
    pairs_[i].pairs.reserve(kUsualPairs);
  }
  places_.resize();
}

void WindowSteps::grow_older() {
  for (int& age : ages_) ++age;
}

}  // namespace retarget
