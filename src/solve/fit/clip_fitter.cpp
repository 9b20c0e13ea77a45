#include "solve/fit/clip_fitter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"
#include "solve/fit/block_chain.h"
#include "solve/fit/contact_places.h"
#include "solve/fit/crossing_terms.h"
#include "solve/fit/fit_dynamics.h"
#include "solve/fit/frame_damping.h"
#include "solve/fit/held_limits.h"
#include "solve/fit/joint_speeds.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kBase = KinematicTree::kBaseDofs;

// Largest change of a variable per step: joints and root rotation (rad), root position (m).
constexpr double kMaxTurn = 0.15, kMaxMove = 0.2;
constexpr int kPairsEvery = 4;         // Steps between two updates of the near pairs.
constexpr double kPairsWithin = 0.04;  // Metres.
// Near pairs of a frame of a stream for which there is room; more of them allocate.
constexpr std::size_t kUsualPairs = 256;
// Initial share of the anchor weight. An anchor is the mean position of the foot end that it holds,
// so at full weight neither would move.
constexpr double kFirstHold = 0.12;
// Predicted decrease, as a share of the cost, above which a window takes extra steps before its
// dynamics. They plan from the current poses, and from poses far from the result they plan wrongly.
constexpr double kSettled = 0.03;
// Penetration, including the self-collision margin, that makes a motion unusable on a robot;
// metres.
constexpr double kDeepOverlap = 0.015;

// The solver of one window.
class WindowFitter final : public MovingFit {
 public:
  WindowFitter(const FitModel& model, const FitOptions& options, const FitWindow& window,
               FitClip& clip);

  FitStatus run(const std::function<bool()>& keep_going);

  void move(int begin, int forgotten) override;
  bool step() override;

 private:
  // All state that the steps change.
  struct Before {
    std::vector<double> qpos;
    std::vector<Eigen::Vector2d> anchors;  // Of the phases that the window owns.
    FrameDamping::State damping;
    std::vector<BoundSide> held;
    std::vector<Eigen::Vector2d> anchor_pushes;
    std::vector<NearList> pairs;
    FitStatus status;
  };

  [[nodiscard]] Before state() const;
  void restore(const Before& before);
  bool steps(int begin, int end, const std::function<bool()>& keep_going);
  bool settle(int first_step, const std::function<bool()>& keep_going);
  bool finish(int first_step, const std::function<bool()>& keep_going);
  void add_dynamics(int first_step, const std::function<bool()>& keep_going);
  void iterate(bool move_anchors, bool look_for_pairs);
  std::optional<double> eliminate(bool move_anchors, bool look_for_pairs);
  double fill_frame(int frame, bool move_anchors, bool look_for_pairs);
  [[nodiscard]] bool is_finite(int local, double cost);
  [[nodiscard]] bool has_finite_solution() const;
  void add_steps(int frame, double* h, double* g);
  void move_base(std::span<const double> x, std::span<double> qpos);
  void apply(int frame);
  [[nodiscard]] bool owns(std::size_t phase) const {
    return window_.owns(clip_.feet.phases[phase]);
  }
  [[nodiscard]] double hold_after(int steps) const {
    const double left = options_.anchor_iterations - steps;
    return left <= 0.0 ? 1.0 : 1.0 - (1.0 - kFirstHold) * left / options_.anchor_iterations;
  }
  [[nodiscard]] int local(int frame) const { return frame - window_.begin; }

  const FitModel& model_;
  const FitOptions& options_;
  FitWindow window_;
  FitClip& clip_;
  int dofs_;
  bool before_, after_;  // Whether a fixed frame precedes the window, or follows it.
  FrameTerms terms_;
  std::optional<FitDynamics> dynamics_;
  bool with_dynamics_ = false;  // Whether the current step includes the dynamics terms.
  TreeState pose_;
  TreeState pose_before_;  // Of the frame before, while crossings are found.
  std::optional<CrossingTerms> crossings_;
  JointSpeeds speeds_;
  BlockChain chain_;
  std::vector<NearList> pairs_;  // One per frame.
  // Largest change of a distance for which the pairs stay: half of that after which a shape that
  // was not near may overlap. The other half is for the steps until the next update.
  double pairs_stay_;
  FrameDamping damping_;
  HeldLimits held_;
  std::vector<int> ages_;  // One per frame: number of steps so far; only for a sliding window.
  std::vector<StepTerm> steps_before_, steps_after_;  // Step terms before and after the current
                                                      // frame, by dof.
  std::vector<double> applied_;                       // Change applied to the current frame, by
                                                      // dof.
  std::vector<double> given_;  // Configuration with the positions of joints that do not move.
  double anchor_hold_ = 1.0;
  int settling_steps_ = 0;
  double worst_overlap_ = 0.0;  // Largest sum of squared penetrations of a frame in the last step,
                                // including the margin; square metres.
  ContactPlaces places_;
  FitStatus status_;
};

WindowFitter::WindowFitter(const FitModel& model, const FitOptions& options,
                           const FitWindow& window, FitClip& clip)
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
      places_(model, clip),
      status_{.begin = window.begin, .end = window.end} {
  if (options.dynamics && FitDynamics::possible(model)) {
    dynamics_.emplace(model, options, window, clip);
  }
  for (int i = kBase; i < dofs_; ++i) {
    given_[at(model.tree.links()[at(i - kBase + 1)].qpos_address)] = model.lower[at(i)];
  }
  if (window.between_frames) crossings_.emplace(model, clip, window_);
}

FitStatus WindowFitter::run(const std::function<bool()>& keep_going) {
  const int first_with_dynamics =
      dynamics_ ? std::max(0, options_.iterations - options_.dynamics_iterations)
                : options_.iterations;
  const bool running = steps(0, first_with_dynamics, keep_going);
  if (!dynamics_) {
    finish(options_.iterations, keep_going);
  } else if (running && settle(first_with_dynamics, keep_going)) {
    add_dynamics(first_with_dynamics + settling_steps_, keep_going);
  }
  status_.converged = !status_.failed && status_.predicted_decrease <= kFitTolerance;
  return status_;
}

// Runs the last steps with dynamics. If dynamics do not help or cannot be computed, restores the
// state and runs these steps without dynamics.
void WindowFitter::add_dynamics(int first_step, const std::function<bool()>& keep_going) {
  const auto take_last_steps = [&] {
    // Without dynamics, the settling steps are some of the window's own steps.
    const int end = with_dynamics_ ? options_.iterations + settling_steps_
                                   : std::max(first_step, options_.iterations);
    return steps(first_step, end, keep_going) && finish(end, keep_going);
  };
  const double unexplained = dynamics_->begin(clip_);
  bool failed = !std::isfinite(unexplained), running = !failed;
  if (!failed && !dynamics_->is_needed()) {
    take_last_steps();
    return;
  }
  const Before before = state();
  if (!failed) {
    with_dynamics_ = true;
    running = take_last_steps();
    with_dynamics_ = false;
    status_.distrusted_frames = dynamics_->distrusted_frames();
    failed = status_.failed;
  }
  if (!failed && !running) return;
  const double left = failed ? unexplained : dynamics_->measure(clip_);
  failed = failed || !std::isfinite(left);
  if (!failed && dynamics_->has_helped(unexplained, left)) return;
  restore(before);
  take_last_steps();
  status_.distrusted_frames = 0;
  // If the window also fails without dynamics, they are not the cause.
  status_.dynamics_failed = failed && !status_.failed;
  status_.dynamics_taken_back = !failed;
}

// @return false if keep_going stopped the fit or a value is not finite.
bool WindowFitter::steps(int begin, int end, const std::function<bool()>& keep_going) {
  for (int i = begin; i < end; ++i) {
    if (keep_going && !keep_going()) return false;
    const bool move_anchors = i < options_.anchor_iterations;
    anchor_hold_ = 1.0;
    if (move_anchors) {
      places_.place(window_);
      anchor_hold_ = hold_after(i);
    }
    if (with_dynamics_ && !dynamics_->plan(clip_)) {
      status_.failed = true;
      return false;
    }
    iterate(move_anchors, i % kPairsEvery == 0);
  }
  return true;
}

// Runs extra steps, from `first_step` on, until the window has nearly converged. A window without a
// successful step does not settle.
bool WindowFitter::settle(int first_step, const std::function<bool()>& keep_going) {
  while (status_.steps > 0 && !status_.failed && settling_steps_ < options_.extra_iterations &&
         status_.predicted_decrease > kSettled) {
    const int step = first_step + settling_steps_++;
    if (!steps(step, step + 1, keep_going)) return false;
  }
  return true;
}

// Runs extra steps, from `first_step` on, while the predicted decrease is large, for example for overlapping bodies or a
// body that rises from the floor. With dynamics, the goals change in every step; only windows with
// deep overlaps continue.
bool WindowFitter::finish(int first_step, const std::function<bool()>& keep_going) {
  if (with_dynamics_ && worst_overlap_ <= square(kDeepOverlap)) return true;
  const int end = options_.extra_iterations + (with_dynamics_ ? first_step : options_.iterations);
  for (int i = first_step; i < end; ++i) {
    if (status_.steps == 0 || status_.predicted_decrease <= kFitTolerance) break;
    if (!steps(i, i + 1, keep_going)) return false;
  }
  return true;
}

WindowFitter::Before WindowFitter::state() const {
  const auto size = at(model_.configuration_size);
  const auto begin = clip_.qpos.begin() + static_cast<std::ptrdiff_t>(at(window_.begin) * size);
  const auto end = clip_.qpos.begin() + static_cast<std::ptrdiff_t>(at(window_.end) * size);
  Before before{{begin, end},     {},     damping_.state(), held_.sides(),
                places_.pushes(), pairs_, status_};
  // A concurrent window may be writing the other anchors.
  for (std::size_t i = 0; i < clip_.anchors.size(); ++i) {
    if (owns(i)) before.anchors.push_back(clip_.anchors[i]);
  }
  return before;
}

void WindowFitter::restore(const Before& before) {
  const auto size = at(model_.configuration_size);
  std::ranges::copy(before.qpos,
                    clip_.qpos.begin() + static_cast<std::ptrdiff_t>(at(window_.begin) * size));
  auto anchor = before.anchors.begin();
  for (std::size_t i = 0; i < clip_.anchors.size(); ++i) {
    if (owns(i)) clip_.anchors[i] = *anchor++;
  }
  damping_.set_state(before.damping);
  held_.set_sides(before.held);
  places_.set_pushes(before.anchor_pushes);
  pairs_ = before.pairs;
  status_ = before.status;
}

void WindowFitter::iterate(bool move_anchors, bool look_for_pairs) {
  const int first = std::max(window_.begin - (before_ ? 1 + window_.context : 0), 0);
  const int last = std::min(window_.end + (after_ ? 1 + window_.context : 0), clip_.frame_count);
  speeds_.update(model_, clip_, first, last);
  chain_.begin(window_.end - window_.begin);
  held_.begin_step();
  if (crossings_) crossings_->begin_step();
  if (before_) speeds_.terms(window_.begin - 1, steps_after_);
  const auto decrease = eliminate(move_anchors, look_for_pairs);
  status_.predicted_decrease = decrease.value_or(1.0);
  if (!decrease) return;
  chain_.substitute();
  if (!has_finite_solution()) {
    status_.failed = true;
    status_.predicted_decrease = 1.0;
    return;
  }
  ++status_.steps;
  held_.release(chain_);
  for (int frame = window_.begin; frame < window_.end; ++frame) apply(frame);
}

// Assembles and factorises the blocks of all frames.
// @return the predicted cost decrease as a share of the cost. Empty if a block is not positive
//     definite; its frame then gets the maximum damping in the next step.
std::optional<double> WindowFitter::eliminate(bool move_anchors, bool look_for_pairs) {
  double cost = 0.0, decrease = 0.0;
  worst_overlap_ = 0.0;
  for (int frame = window_.begin; frame < window_.end; ++frame) {
    const int t = local(frame);
    cost += fill_frame(frame, move_anchors, look_for_pairs);
    const bool finite = is_finite(t, cost);
    status_.failed = status_.failed || !finite;
    const bool positive = finite && chain_.eliminate(t);
    // Sums b' H^-1 b over the blocks, from the reduced right-hand sides and partial solutions.
    for (int i = 0; positive && i < dofs_; ++i) {
      decrease += chain_.right(t)[i] * chain_.solution(t)[at(i)];
    }
    if (positive && std::isfinite(decrease)) continue;
    ++status_.failed_blocks;
    damping_.maximise(at(t));
    return std::nullopt;
  }
  return cost > 0.0 ? decrease / cost : 0.0;
}

// Assembles the block of a frame.
// @return the frame's cost, including that of the step to the next frame.
double WindowFitter::fill_frame(int frame, bool move_anchors, bool look_for_pairs) {
  const int t = local(frame);
  const bool look_between = crossings_ && look_for_pairs;
  if (look_between) std::swap(pose_, pose_before_);
  pose_.update(clip_.frame(frame, model_.configuration_size));
  const int age = ages_.empty() ? -1 : ages_[at(t)];
  if (options_.self_collision && (age < 0 ? look_for_pairs : age % kPairsEvery == 0)) {
    terms_.update_near_pairs(pose_, kPairsWithin, pairs_stay_, pairs_[at(t)]);
  }
  if (look_between && t > 0) {
    crossings_->find(frame, {pose_before_, pairs_[at(t) - 1].pairs}, {pose_, pairs_[at(t)].pairs});
  }
  double* const h = chain_.block(t);
  double* const g = chain_.right(t);
  TermCosts costs{};
  FrameGoals goals = clip_.goals(frame, model_.tasks.size());
  goals.anchor_hold = age < 0 ? anchor_hold_ : hold_after(age);
  terms_.assemble(pose_, goals, pairs_[at(t)].pairs, g, h, chain_.stride(), costs);
  add_limit_margins(model_, options_, clip_.frame(frame, model_.configuration_size), g, h,
                    chain_.stride(), costs);
  worst_overlap_ =
      std::max(worst_overlap_, costs[kTermSelfCollision] / square(options_.self_collision_weight));
  if (move_anchors) places_.push_apart(window_, frame, terms_.foot_overlap());
  if (crossings_) crossings_->add(frame, terms_, g, h, chain_.stride(), costs);
  // Damping depends on the cost without the anchor term: anchors and their weight change between
  // steps, so their cost does not show whether the step was too long.
  double cost = -costs[kTermContactPlace];
  for (const double part : costs) cost += part;
  // With dynamics, frames may leave their targets so that contacts can supply the forces. That
  // does not show that the step was too long either.
  if (with_dynamics_) cost -= costs[kTermPosition] + costs[kTermRotation];
  damping_.adapt(at(t), cost);
  for (int i = 0; i < dofs_; ++i) {
    double& diagonal = h[static_cast<std::ptrdiff_t>(i) * (chain_.stride() + 1)];
    diagonal += damping_.of(at(t), at(i), diagonal);
  }
  // Added after the damping, because the goals of the dynamics rows change in every step.
  double dynamics_cost = 0.0;
  if (with_dynamics_) dynamics_cost = dynamics_->add_rows(frame, pose_, g, h, chain_.stride());
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
bool WindowFitter::is_finite(int t, double cost) {
  const double* const h = chain_.block(t);
  const double* const g = chain_.right(t);
  bool finite = std::isfinite(cost);
  for (int i = 0; i < dofs_; ++i) {
    const double diagonal = h[static_cast<std::ptrdiff_t>(i) * (chain_.stride() + 1)];
    finite = finite && std::isfinite(g[i]) && std::isfinite(diagonal);
  }
  return finite;
}

bool WindowFitter::has_finite_solution() const {
  for (int frame = window_.begin; frame < window_.end; ++frame) {
    const auto x = chain_.solution(local(frame));
    if (!std::ranges::all_of(x, [](double value) { return std::isfinite(value); })) return false;
  }
  return true;
}

// Adds the terms of the step to this frame and of the step from it.
void WindowFitter::add_steps(int frame, double* h, double* g) {
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

void WindowFitter::move_base(std::span<const double> x, std::span<double> qpos) {
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

void WindowFitter::apply(int frame) {
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
  if (with_dynamics_) dynamics_->moved(frame, applied_);
}

void WindowFitter::move(int begin, int forgotten) {
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

bool WindowFitter::step() {
  status_.failed = false;
  iterate(true, false);
  for (int& age : ages_) ++age;
  places_.place(window_);
  return !status_.failed;
}

}  // namespace

std::unique_ptr<MovingFit> make_moving_fit(const FitModel& model, const FitOptions& options,
                                           FitClip& clip, int context) {
  return std::make_unique<WindowFitter>(model, options, FitWindow{0, 0, true, context}, clip);
}

FitStatus fit_window(const FitModel& model, const FitOptions& options, const FitWindow& window,
                     FitClip& clip, const std::function<bool()>& keep_going) {
  return WindowFitter(model, options, window, clip).run(keep_going);
}

}  // namespace retarget
