#include "solve/targets/limit_diagnosis.h"

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <utility>

#include "base/math/se3.h"
#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "solve/ik/ik_solver.h"
#include "solve/ik/published_jacobian.h"

namespace retarget {
namespace {

// LimitPush::strength and ::shortfall of a task, summed over frames: position, then rotation.
struct TaskPush {
  std::array<double, 2> strength{};
  std::array<double, 2> shortfall{};
};

// A joint at one of its limits, with sums over the frames seen so far.
struct Candidate {
  JointAtLimit found;
  int pass = 0;  // Last pass that moves the joint.
  int link = KinematicTree::kWorld;
  std::vector<TaskPush> tasks;  // By task of the pass.
};

bool is_at(const LimitSet& limits, std::size_t joint, bool upper, double q) {
  return upper ? q >= limits.upper[joint] - kDiagnosedAtLimit
               : q <= limits.lower[joint] + kDiagnosedAtLimit;
}

std::vector<Candidate> find_candidates(const RobotClip& clip, const LimitSet& limits,
                                       double min_share) {
  std::vector<Candidate> candidates;
  const auto& joints = clip.robot().joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (limits.lower[j] == limits.upper[j]) continue;
    for (const bool upper : {false, true}) {
      int frames = 0;
      for (int frame = 0; frame < clip.frame_count(); ++frame) {
        frames += is_at(limits, j, upper, clip.qpos(frame)[joints[j].qpos_address]) ? 1 : 0;
      }
      const double share = static_cast<double>(frames) / std::max(1, clip.frame_count());
      if (frames == 0 || share < min_share) continue;
      Candidate candidate;
      candidate.found.joint = static_cast<int>(j);
      candidate.found.at_upper = upper;
      candidate.found.frames = frames;
      candidate.found.share = share;
      candidates.push_back(std::move(candidate));
    }
  }
  return candidates;
}

// Finds the robot's limit set that is widest at the joint's limit.
void find_wider_set(const Robot& robot, const LimitSet& limits, JointAtLimit& found) {
  std::vector<const LimitSet*> sets;
  for (const LimitSet& set : robot.profile().limit_sets) sets.push_back(&set);
  sets.push_back(&robot.model_limits());
  for (const LimitSet* set : sets) {
    const double wider = found.at_upper ? set->upper[found.joint] - limits.upper[found.joint]
                                        : limits.lower[found.joint] - set->lower[found.joint];
    if (wider > kDiagnosedAtLimit && wider > found.wider_by) {
      found.wider_set = set->name;
      found.wider_by = wider;
    }
  }
}

// Sums the pushes of a pass's tasks on the candidates over frames.
class PushSum {
 public:
  PushSum(const Robot& robot, const IkPass& pass)
      : pass_(pass), tree_(robot.tree()), state_(tree_) {}

  // The joint's link; kWorld if the joint moves no body of the pass's tasks.
  [[nodiscard]] int link_of(int joint) const {
    const int link = tree_.link_of_joint(joint);
    const bool moves =
        std::ranges::any_of(pass_, [&](const FrameTask& task) { return carries(link, task); });
    return moves ? link : KinematicTree::kWorld;
  }

  [[nodiscard]] std::size_t task_count() const { return pass_.size(); }

  // Updates the kinematics. Call add() for each candidate of the frame afterwards.
  void set_frame(std::span<const double> qpos) { state_.update(qpos); }

  void add(Candidate& candidate, std::span<const Pose> world_from_target) const {
    for (std::size_t t = 0; t < pass_.size(); ++t) {
      if (!carries(candidate.link, pass_[t])) continue;
      add_task(candidate, t, world_from_target[pass_[t].target]);
    }
  }

  // The strongest push, averaged over the frames.
  [[nodiscard]] std::optional<LimitPush> strongest(const Candidate& candidate,
                                                   const std::vector<Bone>& bones) const {
    std::optional<LimitPush> strongest;
    for (std::size_t t = 0; t < pass_.size(); ++t) {
      for (const int part : {0, 1}) {
        const double strength = candidate.tasks[t].strength[part] / candidate.found.frames;
        if (strength <= (strongest ? strongest->strength : 0.0)) continue;
        strongest = LimitPush{pass_[t].body, bones[pass_[t].target], part == 1, strength,
                              candidate.tasks[t].shortfall[part] / candidate.found.frames};
      }
    }
    return strongest;
  }

 private:
  [[nodiscard]] bool carries(int link, const FrameTask& task) const {
    return tree_.carries(link, tree_.attachment(task.body).link);
  }

  // The pull of the task's error on a unit velocity of the joint: half the rate at which the
  // squared error falls.
  void add_task(Candidate& candidate, std::size_t t, const Pose& world_from_target) const {
    const FrameTask& task = pass_[t];
    const Pose world_from_body = state_.world_from_body(task.body);
    const int dof = KinematicTree::dof_of(candidate.link);
    const Eigen::Quaterniond body_from_world = world_from_body.rotation.conjugate();
    Vector6d velocity;  // Of the body, in its axes.
    velocity << body_from_world * state_.velocity_at(dof, world_from_body.translation),
        body_from_world * Eigen::Vector3d(state_.angular[dof]);
    const Vector6d error = log_se3(world_from_body.inverse() * world_from_target);
    const Vector6d fall = published_jacobian_inverse(error) * velocity;

    const double outward = candidate.found.at_upper ? 1.0 : -1.0;
    const double to_position = error.head<3>().dot(fall.head<3>());
    const double to_rotation = error.tail<3>().dot(fall.tail<3>());
    TaskPush& push = candidate.tasks[t];
    push.strength[0] += outward * task.position_weight * task.position_weight * to_position;
    push.strength[1] += outward * task.rotation_weight * task.rotation_weight * to_rotation;
    push.shortfall[0] += (world_from_target.translation - world_from_body.translation).norm();
    push.shortfall[1] += error.tail<3>().norm();
  }

  IkPass pass_;
  const KinematicTree& tree_;
  TreeState state_;
};

// Assigns a pass to each candidate and removes candidates that no task moves.
void find_passes(const std::vector<PushSum>& sums, std::vector<Candidate>& candidates) {
  for (Candidate& candidate : candidates) {
    for (int pass = static_cast<int>(sums.size()) - 1; pass >= 0; --pass) {
      candidate.link = sums[pass].link_of(candidate.found.joint);
      if (candidate.link == KinematicTree::kWorld) continue;
      candidate.pass = pass;
      candidate.tasks.resize(sums[pass].task_count());
      break;
    }
  }
  std::erase_if(candidates, [](const Candidate& one) { return one.link == KinematicTree::kWorld; });
}

}  // namespace

std::vector<JointAtLimit> joints_at_limits(const RobotClip& clip, const ResolvedConfig& config,
                                           const TargetBuilder& targets,
                                           const HumanPoseSource& poses, const LimitSet& limits,
                                           double min_share) {
  std::vector<Candidate> candidates = find_candidates(clip, limits, min_share);
  if (candidates.empty()) return {};
  const Robot& robot = clip.robot();
  // A guessed rotation does not explain why a joint is at its limit.
  ResolvedConfig known = config;
  for (ResolvedConfig::Table& table : known.match_tables) {
    for (ConfigTask& task : table.tasks) {
      if (task.rotation_is_guess) task.rotation_weight = 0.0;
    }
  }
  const auto problem = make_problem(clip.shared_robot(), known, targets, limits);
  std::vector<PushSum> sums;
  for (const IkPass& pass : problem->passes) sums.emplace_back(robot, pass);
  find_passes(sums, candidates);
  std::set<int> passes;
  for (const Candidate& candidate : candidates) passes.insert(candidate.pass);
  HumanPose world_from_bone;
  std::vector<Pose> world_from_target(targets.target_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    bool is_set = false;
    for (Candidate& candidate : candidates) {
      const double q = qpos[robot.joints()[candidate.found.joint].qpos_address];
      if (!is_at(limits, candidate.found.joint, candidate.found.at_upper, q)) continue;
      if (!is_set) {
        for (const int pass : passes) sums[pass].set_frame(qpos);
        poses(frame, world_from_bone);
        targets.build(world_from_bone, world_from_target);
        is_set = true;
      }
      sums[candidate.pass].add(candidate, world_from_target);
    }
  }
  const std::vector<Bone> bones = targets.bones();
  std::vector<JointAtLimit> result;
  for (Candidate& candidate : candidates) {
    candidate.found.push = sums[candidate.pass].strongest(candidate, bones);
    find_wider_set(robot, limits, candidate.found);
    result.push_back(std::move(candidate.found));
  }
  std::ranges::stable_sort(result, std::ranges::greater(), &JointAtLimit::frames);
  return result;
}

}  // namespace retarget
