#include "solve/fit/limb_detours.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/trigonometry.h"
#include "solve/fit/limb_frame.h"
#include "solve/fit/limb_path.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/task_terms.h"
#include "solve/fit/window_trial.h"

namespace retarget {
namespace {

constexpr double kAround = 0.6;  // Seconds of a path before and after the frames with large errors.
constexpr double kOthersEvery = 0.2;  // Seconds between two searches for other branches.
constexpr double kFarAround = 3.0;    // Seconds around an interval that a longer search adds.
constexpr double kLongest = 10.0;     // Longest interval that is searched, seconds.
constexpr double kMoreVisible = 1.1;  // Largest ratio of visible_error() after and before a change.
constexpr double kTwisted = 0.17453292519943295;  // Rotation error of the trunk: 10 degrees.

// Appends an interval, or extends the last one if they meet.
void add(const FrameRange& next, std::vector<FrameRange>& intervals) {
  if (!intervals.empty() && next.begin <= intervals.back().end) {
    intervals.back().end = std::max(intervals.back().end, next.end);
  } else {
    intervals.push_back(next);
  }
}

class ArmStraightener {
 public:
  ArmStraightener(const FitModel& model, const FitOptions& options, FitClip& clip,
                  const FitLimb& arm, const std::function<bool()>& keep_going,
                  BranchRecovery& result)
      : model_(model),
        options_(options),
        clip_(clip),
        arm_(arm),
        keep_going_(keep_going),
        result_(result),
        frame_(model, clip, arm_),
        finder_(model, options, clip, arm_),
        branches_(model, options, clip, arm_) {
    for (std::size_t k = 0; k < model.tasks.size(); ++k) {
      const FitTask& task = model.tasks[k];
      if (task.rotation_weight > 0.0 && model.tree.carries(task.link, arm.link)) trunk_task_ = k;
    }
  }

  void straighten(const std::vector<FrameRange>& intervals) {
    for (const FrameRange& interval : intervals) {
      if (interval.end - interval.begin <= clip_.frames_in(kLongest)) reroute(interval);
      if (result_.stopped) return;
    }
  }

 private:
  double cost(int t) {
    frame_.set(t);
    return frame_.cost();
  }
  bool is_trunk_twisted(const FrameRange& interval);
  double visible_error(const FitWindow& window);
  bool release_trunk(WindowTrial& trial);
  std::vector<LimbPlace> other_branches(const FrameRange& interval);
  std::optional<LimbBranch> find_far(const FrameRange& interval);
  void trim(LimbBranch& path);
  void reroute(const FrameRange& interval);

  const FitModel& model_;
  const FitOptions& options_;
  FitClip& clip_;
  FitLimb arm_;
  const std::function<bool()>& keep_going_;
  BranchRecovery& result_;
  LimbFrame frame_;
  LimbPathFinder finder_;
  BranchFinder branches_;
  std::optional<std::size_t> trunk_task_;  // The task of the body that carries the arm.
  std::optional<FitModel> without_arm_;    // The model without the arm's weights; made on demand.
};

bool ArmStraightener::is_trunk_twisted(const FrameRange& interval) {
  if (!trunk_task_) return false;
  const int link = model_.tasks[*trunk_task_].link;
  for (int t = interval.begin; t < interval.end; ++t) {
    frame_.set(t);
    const TaskTarget& target = frame_.goals().targets[*trunk_task_];
    if (rotation_error(frame_.pose().world_from_link[at(link)], target).norm() > kTwisted) {
      return true;
    }
  }
  return false;
}

// The sum of squared errors of the tracked directions of arm bones and of the rotation of the trunk,
// rad^2. Twists of arms are hardly visible, so a path that lowers them must not turn the trunk.
double ArmStraightener::visible_error(const FitWindow& window) {
  double sum = 0.0;
  for (int t = window.begin; t < window.end; ++t) {
    frame_.set(t);
    for (std::size_t k = 0; k < model_.tasks.size(); ++k) {
      const FitTask& task = model_.tasks[k];
      const Pose& world_from_link = frame_.pose().world_from_link[at(task.link)];
      const TaskTarget& target = frame_.goals().targets[k];
      const auto bone = limb_bone(task.bone);
      if ((bone == LimbBone::kArm || bone == LimbBone::kForeArm) && task.rotation_weight > 0.0) {
        const Eigen::Vector3d axis = world_from_link.rotation * task.twist_axis;
        const Eigen::Vector3d wanted = target.world_from_link * task.twist_axis;
        sum += square(portable::atan2(axis.cross(wanted).norm(), axis.dot(wanted)));
      } else if (k == trunk_task_) {
        sum += rotation_error(world_from_link, target).squaredNorm();
      }
    }
  }
  return sum;
}

// An arm far from its targets also rotates the trunk, which can put other branches out of reach.
// Therefore solves the window without the arm's tasks, then restores the arm's joint positions.
bool ArmStraightener::release_trunk(WindowTrial& trial) {
  if (!without_arm_) {
    without_arm_ = model_;
    for (const std::size_t k : arm_.tasks) {
      FitTask& task = without_arm_->tasks[k];
      task.horizontal_weight = task.height_weight = 0.0;
      task.rotation_weight = task.twist_weight = 0.0;
    }
  }
  FitOptions few = options_;
  few.iterations = std::min(3, options_.iterations);
  few.extra_iterations = 0;
  few.dynamics = false;
  if (!trial.solve(*without_arm_, few)) return false;
  for (int t = trial.window().begin; t < trial.window().end; ++t) {
    const auto frame = clip_.frame(t, model_.configuration_size);
    for (const int link : arm_.links) {
      joint_value(model_, link, frame) =
          trial.before(t)[at(model_.tree.links()[at(link)].qpos_address)];
    }
  }
  return true;
}

// Configurations in which the arm follows its targets better, and which small steps from the
// current one do not reach.
std::vector<LimbPlace> ArmStraightener::other_branches(const FrameRange& interval) {
  const double off = astray_cost(model_, arm_);
  std::vector<LimbPlace> found;
  const int every = std::max(1, clip_.frames_in(kOthersEvery));
  for (int t = interval.begin; t < interval.end; t += every) {
    if (!(cost(t) > off)) continue;
    if (const auto other = branches_.other_configuration(t, 0.5 * off)) {
      found.push_back({t, *other});
    }
  }
  return found;
}

// Searches for a better path around an interval. An arm changes branches only in certain poses,
// which may be seconds away. The search is slow, so it is limited to arms that are astray for long
// and have another branch.
std::optional<LimbBranch> ArmStraightener::find_far(const FrameRange& interval) {
  constexpr double kShortest = 0.3;  // Seconds that the arm must be astray.
  const double off = astray_cost(model_, arm_);
  int astray = 0;
  for (int t = interval.begin; t < interval.end; ++t) astray += cost(t) > off ? 1 : 0;
  if (astray <= clip_.frames_in(kShortest)) return std::nullopt;
  const std::vector<LimbPlace> others = other_branches(interval);
  if (others.empty()) return std::nullopt;
  const int around = clip_.frames_in(kFarAround);
  auto path = finder_.find(std::max(0, interval.begin - around),
                           std::min(clip_.frame_count, interval.end + around), others);
  if (path) trim(*path);
  return path;
}

// Removes the frames at both ends of a path that it does not change.
void ArmStraightener::trim(LimbBranch& path) {
  constexpr double kSame = 1e-3;  // rad.
  const auto is_same = [&](int t, const LimbJoints& joints) {
    frame_.set(t);
    const LimbJoints own = frame_.joints();
    for (std::size_t i = 0; i < arm_.links.size(); ++i) {
      if (std::abs(joints[i] - own[i]) > kSame) return false;
    }
    return true;
  };
  while (path.end - path.begin > 1 && is_same(path.end - 1, path.joints.back())) {
    path.joints.pop_back();
    --path.end;
  }
  const int begin = path.begin;
  while (path.end - path.begin > 1 && is_same(path.begin, path.joints[at(path.begin - begin)])) {
    ++path.begin;
  }
  path.joints.erase(path.joints.begin(), path.joints.begin() + (path.begin - begin));
}

void ArmStraightener::reroute(const FrameRange& interval) {
  FrameRange changed;
  std::optional<WindowTrial> trial;
  double before = 0.0, visible_before = 0.0;
  const auto arm_cost = [&] {
    double sum = 0.0;
    for (int t = changed.begin; t < changed.end; ++t) sum += cost(t);
    return sum;
  };
  // @return false if the trunk remains twisted.
  const auto begin_trial = [&](const FrameRange& window) {
    changed = window;
    trial.emplace(model_, options_, clip_, keep_going_, window.begin, window.end);
    before = arm_cost();
    visible_before = visible_error(trial->window());
    return !is_trunk_twisted(window) || release_trunk(*trial);
  };
  bool is_free = begin_trial(interval);
  std::optional<LimbBranch> path;
  if (is_free) path = finder_.find(interval.begin, interval.end, {});
  if (is_free && !path) {
    path = find_far(interval);
    if (path) {
      result_.conclude(*trial, false);
      is_free =
          begin_trial({std::min(interval.begin, path->begin), std::max(interval.end, path->end)});
    }
  }
  std::optional<RecoveredLimb> recovered;
  if (path && is_free) {
    put_limb(model_, arm_, *path, clip_);
    if (trial->solve() && trial->pays_off() &&
        visible_error(trial->window()) <= kMoreVisible * visible_before) {
      recovered = {arm_.name, changed.begin, changed.end, before, arm_cost()};
    }
  }
  result_.conclude(*trial, recovered);
}

}  // namespace

FitLimb without_hand(const FitModel& model, const FitLimb& limb) {
  FitLimb part = limb;
  std::erase_if(part.tasks,
                [&](std::size_t k) { return limb_bone(model.tasks[k].bone) == LimbBone::kHand; });
  std::erase_if(part.links, [&](int link) {
    return std::ranges::none_of(
        part.tasks, [&](std::size_t k) { return model.tree.carries(link, model.tasks[k].link); });
  });
  return part;
}

std::vector<FrameRange> astray_intervals(const FitModel& model, const FitClip& clip,
                                         const FitLimb& arm) {
  const FitLimb part = without_hand(model, arm);
  const double off = astray_cost(model, part);
  std::vector<FrameRange> found;
  if (part.links.empty() || !(off > 0.0)) return found;
  LimbFrame frame(model, clip, part);
  const int around = clip.frames_in(kAround);
  for (int t = 0; t < clip.frame_count; ++t) {
    frame.set(t);
    if (!(frame.cost() > off)) continue;
    add({std::max(0, t - around), std::min(clip.frame_count, t + around + 1)}, found);
  }
  return found;
}

void straighten_arm(const FitModel& model, const FitOptions& options, FitClip& clip,
                    const FitLimb& arm, const std::vector<FrameRange>& astray,
                    const std::function<bool()>& keep_going, BranchRecovery& result) {
  const FitLimb part = without_hand(model, arm);
  if (part.links.empty()) return;
  std::vector<FrameRange> intervals = astray;
  if (!result.limbs.empty()) {
    intervals = astray_intervals(model, clip, arm);
    std::ranges::copy(astray, std::back_inserter(intervals));
    std::ranges::sort(intervals, {}, &FrameRange::begin);
    std::vector<FrameRange> merged;
    for (const FrameRange& interval : intervals) add(interval, merged);
    intervals = std::move(merged);
  }
  if (intervals.empty()) return;
  ArmStraightener(model, options, clip, part, keep_going, result).straighten(intervals);
}

}  // namespace retarget
