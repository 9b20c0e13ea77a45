#include "solve/fit/branch_recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "retarget/clip.h"
#include "retarget/kinematic_tree.h"
#include "retarget/text.h"
#include "solve/fit/bad_intervals.h"
#include "solve/fit/limb_branch.h"
#include "solve/fit/limb_detours.h"
#include "solve/fit/limb_solver.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/window_trial.h"

namespace retarget {
namespace {

constexpr double kSampleTime = 0.1;                   // Seconds between two samples of the costs.
constexpr int kShortestWait = 5, kLongestWait = 320;  // Samples between two searches.
constexpr int kMinSamples = 3;                        // Samples that a large error must last.
constexpr double kAstrayBranch = 0.3490658503988659;  // Rotation error of a bone: 20 degrees.
// Largest shares of the limb's tracking cost and of its error that may remain after a change, both
// summed over the changed frames.
constexpr double kLessOnLimb = 0.7;
constexpr double kLessError = 0.9;

// Tracking costs of the limbs, sampled at regular intervals.
class LimbCostSamples {
 public:
  LimbCostSamples(const FitModel& model, const FitClip& clip, const std::vector<FitLimb>& limbs)
      : model_(model),
        clip_(clip),
        pose_(model.tree),
        every_(std::max(1, static_cast<int>(std::lround(kSampleTime / clip.frame_time)))),
        count_((clip.frame_count + every_ - 1) / every_) {
    for (const FitLimb& limb : limbs) {
      solvers_.emplace_back(model, limb);
      costs_.emplace_back(at(count_));
    }
    update(0, clip.frame_count);
  }

  // Samples frames [begin, end) again after they changed.
  void update(int begin, int end) {
    for (int i = index_from(begin); i * every_ < end; ++i) {
      pose_.update(clip_.frame(i * every_, model_.configuration_size));
      const FrameGoals goals = clip_.goals(i * every_, model_.tasks.size());
      for (std::size_t limb = 0; limb < solvers_.size(); ++limb) {
        costs_[limb][at(i)] = solvers_[limb].cost(pose_, goals);
      }
    }
  }

  [[nodiscard]] const std::vector<double>& costs(std::size_t limb) const { return costs_[limb]; }
  [[nodiscard]] int frame(int index) const { return index * every_; }
  // Index of the first sample at or after this frame.
  [[nodiscard]] int index_from(int frame) const { return (frame + every_ - 1) / every_; }

 private:
  const FitModel& model_;
  const FitClip& clip_;
  TreeState pose_;
  int every_;  // Frames between two samples.
  int count_;
  std::vector<LimbSolver> solvers_;
  std::vector<std::vector<double>> costs_;  // By limb and sample.
};

// Samples [begin, end) in which a limb is astray.
struct AstraySamples {
  int begin = 0, end = 0;
};

// The first interval at or after sample `from` in which the costs exceed `astray`.
std::optional<AstraySamples> next_astray(const std::vector<double>& costs, double astray,
                                         int from) {
  constexpr int kMost = 50;  // A longer interval is split; the next call finds its remainder.
  const auto count = static_cast<int>(costs.size());
  for (int begin = from; begin < count; ++begin) {
    AstraySamples found{begin, begin};
    const int last = std::min(count, begin + kMost);
    while (found.end < last && costs[at(found.end)] > astray) ++found.end;
    if (found.end - begin >= std::min(kMinSamples, count)) return found;
    begin = found.end;
  }
  return std::nullopt;
}

// Moves limbs of a clip to other branches and reverts changes that do not lower the cost enough.
class BranchChanger {
 public:
  BranchChanger(const FitModel& model, const FitOptions& options, FitClip& clip,
                const std::function<bool()>& keep_going, LimbCostSamples& samples,
                BranchRecovery& result)
      : model_(model),
        options_(options),
        clip_(clip),
        keep_going_(keep_going),
        samples_(samples),
        result_(result) {}

  void recover(const FitLimb& limb, const std::vector<double>& costs);
  // Moves both arms at once while both are astray. The trunk would follow an arm that moves alone,
  // and the other arm would then choose a branch that suits the turned trunk.
  void recover_arms(const std::vector<FitLimb>& limbs);

 private:
  // A branch of a limb that take() tries.
  struct Move {
    const FitLimb* limb;
    BranchFinder* finder;
    LimbBranch branch;
  };
  [[nodiscard]] int worst_sample(const AstraySamples& astray, BranchFinder& finder) const;
  [[nodiscard]] std::optional<Move> find_move(const FitLimb& limb, int frame,
                                              BranchFinder& finder) const;
  [[nodiscard]] std::vector<Move> moves_of_both(const std::array<const FitLimb*, 2>& arms,
                                                std::array<BranchFinder, 2>& finders,
                                                const AstraySamples& astray) const;
  bool take(std::span<const Move> moves);

  const FitModel& model_;
  const FitOptions& options_;
  FitClip& clip_;
  const std::function<bool()>& keep_going_;
  LimbCostSamples& samples_;
  BranchRecovery& result_;
};

// The sample with the largest BranchFinder::stuck_cost().
int BranchChanger::worst_sample(const AstraySamples& astray, BranchFinder& finder) const {
  int worst = astray.begin;
  double most = 0.0;
  for (int i = astray.begin; i < astray.end; ++i) {
    const double stuck = finder.stuck_cost(samples_.frame(i));
    if (stuck <= most) continue;
    most = stuck;
    worst = i;
  }
  return worst;
}

std::optional<BranchChanger::Move> BranchChanger::find_move(const FitLimb& limb, int frame,
                                                            BranchFinder& finder) const {
  const auto other = finder.other_configuration(frame, 0.5 * astray_cost(model_, limb));
  const auto branch = other ? finder.follow(frame, *other) : std::nullopt;
  if (!branch) return std::nullopt;
  return Move{&limb, &finder, *branch};
}

// Moves of both arms from the same frame: among the frames in which each arm has another
// configuration, the one with the highest cost of the arm that is less stuck. Empty if there is
// none.
std::vector<BranchChanger::Move> BranchChanger::moves_of_both(
    const std::array<const FitLimb*, 2>& arms, std::array<BranchFinder, 2>& finders,
    const AstraySamples& astray) const {
  const std::array off = {astray_cost(model_, *arms[0]), astray_cost(model_, *arms[1])};
  std::vector<std::pair<double, int>> stuck;  // The smaller cost of both arms, and the frame.
  for (int i = astray.begin; i < astray.end; ++i) {
    const int frame = samples_.frame(i);
    stuck.emplace_back(
        std::min(finders[0].stuck_cost(frame) / off[0], finders[1].stuck_cost(frame) / off[1]),
        frame);
  }
  std::ranges::stable_sort(stuck, std::greater(), &std::pair<double, int>::first);
  for (const auto& [cost, frame] : stuck) {
    std::array<std::optional<LimbJoints>, 2> others;
    for (const std::size_t i : {0, 1}) {
      others[i] = finders[i].other_configuration(frame, 0.5 * off[i]);
      if (!others[i]) break;
    }
    if (!others[0] || !others[1]) continue;
    std::vector<Move> moves;
    for (const std::size_t i : {0, 1}) {
      auto branch = finders[i].follow(frame, *others[i]);
      if (!branch) return {};
      moves.push_back({arms[i], &finders[i], std::move(*branch)});
    }
    return moves;
  }
  return {};
}

void BranchChanger::recover_arms(const std::vector<FitLimb>& limbs) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    if (limbs[i].is_arm && astray_cost(model_, limbs[i]) > 0.0) indices.push_back(i);
  }
  if (indices.size() != 2) return;
  const std::array arms = {&limbs[indices[0]], &limbs[indices[1]]};
  std::vector<double> shares(samples_.costs(0).size());
  const auto next_both_astray = [&](int from) {
    for (std::size_t i = 0; i < shares.size(); ++i) {
      shares[i] = std::min(samples_.costs(indices[0])[i] / astray_cost(model_, *arms[0]),
                           samples_.costs(indices[1])[i] / astray_cost(model_, *arms[1]));
    }
    return next_astray(shares, 1.0, from);
  };
  std::optional<std::array<BranchFinder, 2>> finders;
  int wait = kShortestWait;
  for (auto found = next_both_astray(0); found && !result_.stopped;) {
    if (!finders) {
      finders.emplace(std::array{BranchFinder(model_, options_, clip_, *arms[0]),
                                 BranchFinder(model_, options_, clip_, *arms[1])});
    }
    const std::vector<Move> moves = moves_of_both(arms, *finders, *found);
    int next = std::max(found->end, found->begin + wait);
    if (!moves.empty() && take(moves)) {
      wait = kShortestWait;
      next = samples_.index_from(std::max(moves[0].branch.end, moves[1].branch.end));
    } else {
      wait = std::min(2 * wait, kLongestWait);
    }
    found = next_both_astray(next);
  }
}

// After a search without success, the limb probably cannot follow its targets better. The interval
// to the next search therefore doubles each time.
void BranchChanger::recover(const FitLimb& limb, const std::vector<double>& costs) {
  const double astray = astray_cost(model_, limb);
  if (!(astray > 0.0)) return;
  std::optional<BranchFinder> finder;
  int wait = kShortestWait;
  for (auto found = next_astray(costs, astray, 0); found && !result_.stopped;) {
    if (!finder) finder.emplace(model_, options_, clip_, limb);
    const int worst = worst_sample(*found, *finder);
    const auto move = find_move(limb, samples_.frame(worst), *finder);
    int next = std::max(found->end, worst + wait);
    if (move && take({&*move, 1})) {
      wait = kShortestWait;
      next = std::max(worst + 1, samples_.index_from(move->branch.end));
    } else {
      wait = std::min(2 * wait, kLongestWait);
    }
    found = next_astray(costs, astray, next);
  }
}

// Tracking cost of a limb and its square root, each summed over frames.
struct LimbError {
  double cost = 0.0, error = 0.0;
};

LimbError error_of(const LimbBranch& branch, BranchFinder& finder) {
  LimbError sum;
  for (int t = branch.begin; t < branch.end; ++t) {
    const double cost = finder.cost(t);
    sum.cost += cost;
    sum.error += std::sqrt(cost);
  }
  return sum;
}

// @return true if the limbs are now on these branches; otherwise the clip is unchanged.
bool BranchChanger::take(std::span<const Move> moves) {
  constexpr int kRounds = 2;
  const auto errors = [&] {
    std::vector<LimbError> found;
    for (const Move& move : moves) found.push_back(error_of(move.branch, *move.finder));
    return found;
  };
  const auto is_better = [](const LimbError& after, const LimbError& before) {
    return after.cost < kLessOnLimb * before.cost && after.error < kLessError * before.error;
  };
  FrameRange changed{clip_.frame_count, 0};
  for (const Move& move : moves) {
    changed = {std::min(changed.begin, move.branch.begin), std::max(changed.end, move.branch.end)};
  }
  WindowTrial trial(model_, options_, clip_, keep_going_, changed.begin, changed.end);
  const std::vector<LimbError> before = errors();
  for (const Move& move : moves) put_limb(model_, *move.limb, move.branch, clip_);
  std::vector<LimbError> after;
  bool accepted = false;
  for (int round = 0; round < kRounds && !accepted && trial.solve(); ++round) {
    after = errors();
    accepted = std::ranges::equal(after, before, is_better) && trial.pays_off();
  }
  result_.conclude(trial, accepted);
  if (!accepted) return false;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const LimbBranch& branch = moves[i].branch;
    result_.limbs.push_back(
        {moves[i].limb->name, branch.begin, branch.end, before[i].cost, after[i].cost});
  }
  samples_.update(trial.window().begin, trial.window().end);
  return true;
}

// The limbs' indices, those with the smallest errors first: they affect the trunk, and thereby the
// other limbs, least. With a fixed order of sides, a clip and its mirror image would change
// different limbs.
std::vector<std::size_t> by_error(const FitModel& model, const std::vector<FitLimb>& limbs,
                                  const LimbCostSamples& samples) {
  std::vector<std::size_t> order(limbs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto error = [&](std::size_t limb) {
    const std::vector<double>& costs = samples.costs(limb);
    const double astray = astray_cost(model, limbs[limb]);
    return astray > 0.0 ? std::accumulate(costs.begin(), costs.end(), 0.0) / astray : 0.0;
  };
  std::ranges::stable_sort(order, {}, error);
  return order;
}

}  // namespace

double astray_cost(const FitModel& model, const FitLimb& limb) {
  double cost = 0.0;
  for (const std::size_t k : limb.tasks)
    cost += square(kAstrayBranch * model.tasks[k].rotation_weight);
  return cost;
}

BranchRecovery recover_branches(const FitModel& model, const FitOptions& options, FitClip& clip,
                                const std::function<bool()>& keep_going) {
  BranchRecovery result;
  const std::vector<FitLimb> limbs = find_limbs(model);
  LimbCostSamples samples(model, clip, limbs);
  std::vector<std::vector<FrameRange>> astray;
  for (const FitLimb& limb : limbs) {
    astray.push_back(limb.is_arm ? astray_intervals(model, clip, limb) : std::vector<FrameRange>());
  }
  BranchChanger changer(model, options, clip, keep_going, samples, result);
  changer.recover_arms(limbs);
  for (const std::size_t i : by_error(model, limbs, samples)) {
    if (result.stopped) break;
    changer.recover(limbs[i], samples.costs(i));
    if (limbs[i].is_arm && !result.stopped) {
      straighten_arm(model, options, clip, limbs[i], astray[i], keep_going, result);
      samples.update(0, clip.frame_count);
    }
  }
  const auto order = [&](const RecoveredLimb& recovered) {
    const auto limb = std::ranges::find(limbs, recovered.limb, &FitLimb::name);
    return std::pair(limb - limbs.begin(), recovered.begin);
  };
  std::ranges::stable_sort(result.limbs, {}, order);
  solve_sunken_frames(model, options, clip, keep_going, result);
  solve_crossing_frames(model, options, clip, keep_going, result);
  return result;
}

void BranchRecovery::conclude(WindowTrial& trial, const std::optional<RecoveredLimb>& changed) {
  if (changed) limbs.push_back(*changed);
  conclude(trial, changed.has_value());
}

void BranchRecovery::conclude(WindowTrial& trial, bool accepted) {
  if (!accepted) trial.revert();
  stopped = stopped || trial.stopped();
  std::ranges::copy(trial.failures(), std::back_inserter(failures));
}

std::vector<std::string> BranchRecovery::notes() const {
  constexpr int kNamed = 4;
  std::vector<std::string> notes;
  for (auto first = limbs.begin(); first != limbs.end();) {
    const auto last = std::find_if(
        first, limbs.end(), [&](const RecoveredLimb& other) { return other.limb != first->limb; });
    std::string frames;
    double before = 0.0, after = 0.0;
    for (auto one = first; one != last; ++one) {
      before += one->cost_before;
      after += one->cost_after;
      if (one - first < kNamed) {
        frames += fmt::format("{}{} to {}", one == first ? "" : ", ", one->begin, one->end - 1);
      }
    }
    if (last - first > kNamed) {
      frames += " and " + count_text(last - first - kNamed, "more time");
    }
    const std::string percent = number_text(100.0 * std::sqrt(after / before), 0);
    // A change that lowers the cost of the fit may move the limb itself farther from its targets.
    notes.push_back(
        after < before
            ? fmt::format("the {} was stuck on a wrong branch in frames {}; on another branch its "
                          "error is {} % of the previous error",
                          first->limb, frames, percent)
            : fmt::format("the {} is on another branch in frames {}, because the cost of all terms "
                          "is lower there; its own error is {} % of the previous error",
                          first->limb, frames, percent));
    first = last;
  }
  return notes;
}

}  // namespace retarget
