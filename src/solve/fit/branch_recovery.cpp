#include "solve/fit/branch_recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>

#include "retarget/kinematic_tree.h"
#include "retarget/text.h"
#include "solve/fit/clip_fitter.h"
#include "solve/fit/frame_costs.h"
#include "solve/fit/limb_branch.h"
#include "solve/fit/limb_solver.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

constexpr double kLookEvery = 0.1;              // Seconds between two looks at the limbs.
constexpr int kLooks = 3;                       // Looks that an error must last.
constexpr double kAstray = 0.3490658503988659;  // 20 degrees, for all tracked bones.
constexpr double kMargin = 0.5;                 // Seconds solved again on either side.
constexpr double kOverlap = 1.5;                // Seconds of overlap between parts.
// Shares that may remain for a change to pay off: of the total cost, of the tracking cost of the
// limb, and of its error, summed over the changed frames.
constexpr double kLessInAll = 0.97;
constexpr double kLessOnLimb = 0.7;
constexpr double kLessError = 0.9;

// Tracking cost of a limb whose bones are all kAstray off target.
double astray_cost(const FitModel& model, const FitLimb& limb) {
  double cost = 0.0;
  for (const std::size_t k : limb.tasks) cost += square(kAstray * model.tasks[k].rotation_weight);
  return cost;
}

// Tracking costs of the limbs, sampled at regular intervals ("looks").
class LimbLooks {
 public:
  LimbLooks(const FitModel& model, const FitClip& clip, const std::vector<FitLimb>& limbs)
      : model_(model),
        clip_(clip),
        pose_(model.tree),
        every_(std::max(1, static_cast<int>(std::lround(kLookEvery / clip.frame_time)))),
        count_((clip.frame_count + every_ - 1) / every_) {
    for (const FitLimb& limb : limbs) {
      solvers_.emplace_back(model, limb);
      costs_.emplace_back(at(count_));
    }
    look(0, clip.frame_count);
  }

  /// Samples frames [begin, end) again after they changed.
  void look(int begin, int end) {
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
  /// The first look at or after this frame.
  [[nodiscard]] int index_from(int frame) const { return (frame + every_ - 1) / every_; }

 private:
  const FitModel& model_;
  const FitClip& clip_;
  TreeState pose_;
  int every_;  // Frames between two looks.
  int count_;
  std::vector<LimbSolver> solvers_;
  std::vector<std::vector<double>> costs_;  // By limb and look.
};

// Looks [begin, end) at which a limb is astray.
struct AstrayLooks {
  int begin = 0, end = 0;
};

std::optional<AstrayLooks> next_astray(const std::vector<double>& costs, double astray, int from) {
  constexpr int kMost = 50;  // A longer stretch is split; its rest is found by the next call.
  const auto count = static_cast<int>(costs.size());
  for (int begin = from; begin < count; ++begin) {
    AstrayLooks found{begin, begin};
    const int last = std::min(count, begin + kMost);
    while (found.end < last && costs[at(found.end)] > astray) ++found.end;
    if (found.end - begin >= std::min(kLooks, count)) return found;
    begin = found.end;
  }
  return std::nullopt;
}

// Moves limbs of a clip to other branches and reverts changes that do not pay off.
class BranchChanger {
 public:
  BranchChanger(const FitModel& model, const FitOptions& options, FitClip& clip,
                const std::function<bool()>& keep_going, LimbLooks& looks, BranchRecovery& result)
      : model_(model),
        options_(options),
        clip_(clip),
        keep_going_(keep_going),
        looks_(looks),
        result_(result) {}

  void recover(const FitLimb& limb, const std::vector<double>& costs);

 private:
  [[nodiscard]] int frames_in(double seconds) const {
    return static_cast<int>(std::lround(seconds / clip_.frame_time));
  }
  [[nodiscard]] int worst_look(const AstrayLooks& looks, BranchFinder& finder) const;
  bool take(const FitLimb& limb, const LimbBranch& branch, BranchFinder& finder);
  bool solve_again(const FitWindow& window);
  [[nodiscard]] double total_cost(const FitWindow& window) const;

  const FitModel& model_;
  const FitOptions& options_;
  FitClip& clip_;
  const std::function<bool()>& keep_going_;
  LimbLooks& looks_;
  BranchRecovery& result_;
};

// The look with the largest cost that remains after solving the limb from its current
// configuration.
int BranchChanger::worst_look(const AstrayLooks& looks, BranchFinder& finder) const {
  int worst = looks.begin;
  double most = 0.0;
  for (int look = looks.begin; look < looks.end; ++look) {
    const double stuck = finder.stuck_cost(looks_.frame(look));
    if (stuck <= most) continue;
    most = stuck;
    worst = look;
  }
  return worst;
}

// If no other branch is found, the limb cannot do better. The wait until the next search doubles
// each time.
void BranchChanger::recover(const FitLimb& limb, const std::vector<double>& costs) {
  constexpr int kFirstWait = 5, kMaxWait = 320;  // Looks.
  const double astray = astray_cost(model_, limb);
  if (!(astray > 0.0)) return;
  std::optional<BranchFinder> finder;
  int wait = kFirstWait;
  for (auto found = next_astray(costs, astray, 0); found && !result_.stopped;) {
    if (!finder) finder.emplace(model_, options_, clip_, limb);
    const int worst = worst_look(*found, *finder);
    const int frame = looks_.frame(worst);
    const auto other = finder->other_configuration(frame, 0.5 * astray);
    const auto branch = other ? finder->follow(frame, *other) : std::nullopt;
    int next = std::max(found->end, worst + wait);
    if (branch && take(limb, *branch, *finder)) {
      wait = kFirstWait;
      next = std::max(worst + 1, looks_.index_from(branch->end));
    } else {
      wait = std::min(2 * wait, kMaxWait);
    }
    found = next_astray(costs, astray, next);
  }
}

double BranchChanger::total_cost(const FitWindow& window) const {
  // The window also changes the smoothed steps of the frames before and after it.
  const int beside = window.context + 1;
  const FitWindow all{std::max(0, window.begin - beside),
                      std::min(clip_.frame_count, window.end + beside), true, window.context};
  std::vector<TermCosts> costs(at(all.end - all.begin));
  frame_costs(model_, options_, clip_, all, costs);
  double sum = 0.0;
  for (const TermCosts& cost : costs) sum = std::accumulate(cost.begin(), cost.end(), sum);
  return sum;
}

// Solves parts of at most one window length in sequence, so that memory stays bounded.
bool BranchChanger::solve_again(const FitWindow& window) {
  const int length = std::max(frames_in(options_.window), 2 * frames_in(kOverlap) + 1);
  const int count = (window.end - window.begin + length - 1) / length;
  const auto border = [&](int i) {
    return window.begin +
           static_cast<int>(static_cast<std::int64_t>(window.end - window.begin) * i / count);
  };
  for (int i = 0; i < count; ++i) {
    const int begin = std::max(window.begin, border(i) - (i > 0 ? frames_in(kOverlap) : 0));
    const FitWindow part{begin, border(i + 1), true, window.context};
    const FitStatus status = fit_window(model_, options_, part, clip_, [this] {
      result_.stopped = result_.stopped || (keep_going_ && !keep_going_());
      return !result_.stopped;
    });
    if (status.failed) {
      result_.failures.push_back({"fit", part.begin, part.end});
      return false;
    }
  }
  return !result_.stopped;
}

// @return true if the limb is now on that branch; otherwise the clip is unchanged.
bool BranchChanger::take(const FitLimb& limb, const LimbBranch& branch, BranchFinder& finder) {
  constexpr int kRounds = 2;
  const FitWindow window{std::max(0, branch.begin - frames_in(kMargin)),
                         std::min(clip_.frame_count, branch.end + frames_in(kMargin)), true,
                         smoothing_context(clip_.frame_time)};
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
  const std::span<double> solved =
      std::span(clip_.qpos)
          .subspan(at(window.begin) * at(model_.configuration_size),
                   at(window.end - window.begin) * at(model_.configuration_size));
  const std::vector<double> qpos_before(solved.begin(), solved.end());
  const std::vector<Eigen::Vector2d> anchors_before = clip_.anchors;
  const double total_before = total_cost(window);
  const OfLimb before = of_limb();
  for (int t = branch.begin; t < branch.end; ++t) {
    const auto frame = clip_.frame(t, model_.configuration_size);
    for (std::size_t i = 0; i < limb.links.size(); ++i) {
      joint_value(model_, limb.links[i], frame) = branch.joints[at(t - branch.begin)][i];
    }
  }
  for (int round = 0; round < kRounds && solve_again(window); ++round) {
    const OfLimb after = of_limb();
    if (!(after.cost < kLessOnLimb * before.cost && after.error < kLessError * before.error &&
          total_cost(window) < kLessInAll * total_before)) {
      continue;
    }
    result_.limbs.push_back({limb.name, branch.begin, branch.end, before.cost, after.cost});
    looks_.look(window.begin, window.end);
    return true;
  }
  std::ranges::copy(qpos_before, solved.begin());
  clip_.anchors = anchors_before;
  return false;
}

}  // namespace

BranchRecovery recover_branches(const FitModel& model, const FitOptions& options, FitClip& clip,
                                const std::function<bool()>& keep_going) {
  BranchRecovery result;
  const std::vector<FitLimb> limbs = find_limbs(model);
  LimbLooks looks(model, clip, limbs);
  BranchChanger changer(model, options, clip, keep_going, looks, result);
  for (std::size_t i = 0; i < limbs.size() && !result.stopped; ++i) {
    changer.recover(limbs[i], looks.costs(i));
  }
  return result;
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
    notes.push_back(
        fmt::format("the {} was stuck on a wrong branch in frames {}; on another branch its error "
                    "is {} % of the previous error",
                    first->limb, frames, number_text(100.0 * std::sqrt(after / before), 0)));
    first = last;
  }
  return notes;
}

}  // namespace retarget
