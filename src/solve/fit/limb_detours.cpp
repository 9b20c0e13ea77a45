#include "solve/fit/limb_detours.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/limb_frame.h"
#include "solve/fit/limb_path.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/window_trial.h"

namespace retarget {
namespace {

constexpr double kAround = 0.6;  // Seconds of a path before and after the frames with large errors.
constexpr double kLongest = 4.0;                  // Longest interval that is searched, seconds.
constexpr double kTwisted = 0.17453292519943295;  // Rotation error of the trunk: 10 degrees.

class ArmStraightener {
 public:
  ArmStraightener(const FitModel& model, const FitOptions& options, FitClip& clip,
                  const FitLimb& arm, const std::function<bool()>& keep_going,
                  BranchRecovery& result)
      : model_(model),
        options_(options),
        clip_(clip),
        arm_(without_hand(model, arm)),
        keep_going_(keep_going),
        result_(result),
        frame_(model, clip, arm_),
        finder_(model, options, clip, arm_) {
    for (std::size_t k = 0; k < model.tasks.size(); ++k) {
      const FitTask& task = model.tasks[k];
      if (task.rotation_weight > 0.0 && model.tree.carries(task.link, arm.link)) trunk_task_ = k;
    }
  }

  void straighten() {
    for (const FrameRange& interval : intervals()) {
      if (interval.end - interval.begin <= clip_.frames_in(kLongest)) reroute(interval);
      if (result_.stopped) return;
    }
  }

 private:
  double cost(int t) {
    frame_.set(t);
    return frame_.cost();
  }
  std::vector<FrameRange> intervals();
  bool is_trunk_twisted(const FrameRange& interval);
  bool release_trunk(WindowTrial& trial);
  void reroute(const FrameRange& interval);

  const FitModel& model_;
  const FitOptions& options_;
  FitClip& clip_;
  FitLimb arm_;
  const std::function<bool()>& keep_going_;
  BranchRecovery& result_;
  LimbFrame frame_;
  LimbPathFinder finder_;
  std::optional<std::size_t> trunk_task_;  // The task of the body that carries the arm.
  std::optional<FitModel> without_arm_;    // The model without the arm's weights; made on demand.
};

// The frames in which the arm is astray (astray_cost()), with a margin on either side.
std::vector<FrameRange> ArmStraightener::intervals() {
  const double off = astray_cost(model_, arm_);
  std::vector<FrameRange> found;
  if (!(off > 0.0)) return found;
  const int around = clip_.frames_in(kAround);
  for (int t = 0; t < clip_.frame_count; ++t) {
    if (!(cost(t) > off)) continue;
    const FrameRange next{std::max(0, t - around), std::min(clip_.frame_count, t + around + 1)};
    if (!found.empty() && next.begin <= found.back().end) {
      found.back().end = next.end;
    } else {
      found.push_back(next);
    }
  }
  return found;
}

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

void ArmStraightener::reroute(const FrameRange& interval) {
  const auto arm_cost = [&] {
    double sum = 0.0;
    for (int t = interval.begin; t < interval.end; ++t) sum += cost(t);
    return sum;
  };
  WindowTrial trial(model_, options_, clip_, keep_going_, interval.begin, interval.end);
  const double before = arm_cost();
  std::optional<LimbBranch> path;
  if (!is_trunk_twisted(interval) || release_trunk(trial)) {
    path = finder_.find(interval.begin, interval.end);
  }
  std::optional<RecoveredLimb> changed;
  if (path) {
    put_limb(model_, arm_, *path, clip_);
    if (trial.solve() && trial.pays_off()) {
      changed = {arm_.name, interval.begin, interval.end, before, arm_cost()};
    }
  }
  result_.conclude(trial, changed);
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

void straighten_arm(const FitModel& model, const FitOptions& options, FitClip& clip,
                    const FitLimb& arm, const std::function<bool()>& keep_going,
                    BranchRecovery& result) {
  if (without_hand(model, arm).links.empty()) return;
  ArmStraightener(model, options, clip, arm, keep_going, result).straighten();
}

}  // namespace retarget
