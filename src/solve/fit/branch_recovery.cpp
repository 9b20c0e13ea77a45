#include "solve/fit/branch_recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

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

 private:
  [[nodiscard]] int worst_sample(const AstraySamples& astray, BranchFinder& finder) const;
  bool take(const FitLimb& limb, const LimbBranch& branch, BranchFinder& finder);

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

// After a search without success, the limb probably cannot follow its targets better. The interval
// to the next search therefore doubles each time.
void BranchChanger::recover(const FitLimb& limb, const std::vector<double>& costs) {
  constexpr int kFirstWait = 5, kMaxWait = 320;  // Samples.
  const double astray = astray_cost(model_, limb);
  if (!(astray > 0.0)) return;
  std::optional<BranchFinder> finder;
  int wait = kFirstWait;
  for (auto found = next_astray(costs, astray, 0); found && !result_.stopped;) {
    if (!finder) finder.emplace(model_, options_, clip_, limb);
    const int worst = worst_sample(*found, *finder);
    const int frame = samples_.frame(worst);
    const auto other = finder->other_configuration(frame, 0.5 * astray);
    const auto branch = other ? finder->follow(frame, *other) : std::nullopt;
    int next = std::max(found->end, worst + wait);
    if (branch && take(limb, *branch, *finder)) {
      wait = kFirstWait;
      next = std::max(worst + 1, samples_.index_from(branch->end));
    } else {
      wait = std::min(2 * wait, kMaxWait);
    }
    found = next_astray(costs, astray, next);
  }
}

// @return true if the limb is now on that branch; otherwise the clip is unchanged.
bool BranchChanger::take(const FitLimb& limb, const LimbBranch& branch, BranchFinder& finder) {
  constexpr int kRounds = 2;
  WindowTrial trial(model_, options_, clip_, keep_going_, branch.begin, branch.end);
  struct OfLimb {
    double cost = 0.0, error = 0.0;
  };
  const auto of_limb = [&] {
    OfLimb sum;
    for (int t = branch.begin; t < branch.end; ++t) {
      const double cost = finder.cost(t);
      sum.cost += cost;
      sum.error += std::sqrt(cost);
    }
    return sum;
  };
  const OfLimb before = of_limb();
  put_limb(model_, limb, branch, clip_);
  std::optional<RecoveredLimb> changed;
  for (int round = 0; round < kRounds && !changed && trial.solve(); ++round) {
    const OfLimb after = of_limb();
    if (after.cost < kLessOnLimb * before.cost && after.error < kLessError * before.error &&
        trial.pays_off()) {
      changed = {limb.name, branch.begin, branch.end, before.cost, after.cost};
    }
  }
  result_.conclude(trial, changed);
  if (changed) samples_.update(trial.window().begin, trial.window().end);
  return changed.has_value();
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
  for (std::size_t i = 0; i < limbs.size() && !result.stopped; ++i) {
    const auto first = static_cast<std::ptrdiff_t>(result.limbs.size());
    changer.recover(limbs[i], samples.costs(i));
    if (limbs[i].is_arm && !result.stopped) {
      straighten_arm(model, options, clip, limbs[i], astray[i], keep_going, result);
    }
    std::stable_sort(result.limbs.begin() + first, result.limbs.end(),
                     [](const auto& a, const auto& b) { return a.begin < b.begin; });
  }
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
