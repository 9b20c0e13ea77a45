#include "solve/targets/solve_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "base/faults.h"
#include "base/try.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "retarget/trigonometry.h"
#include "solve/targets/frame_solver.h"

namespace retarget {

TargetStream::TargetStream(int frame_count, HumanPoseSource human, const TargetBuilder& targets,
                           bool ahead)
    : frame_count_(frame_count),
      human_(std::move(human)),
      targets_(targets),
      ring_(static_cast<std::size_t>(kChunkFrames * kChunks) * targets.target_count()) {
  if (!ahead || frame_count <= kChunkFrames) return;
  try {
    maker_ = std::thread([this] { make_chunks(); });
  } catch (const std::system_error&) {
    // Without an available thread, next() builds the targets.
  }
}

TargetStream::~TargetStream() {
  if (!maker_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  maker_.join();
}

std::span<const Pose> TargetStream::next() {
  const int frame = frame_++;
  if (frame % kChunkFrames == 0) {
    if (maker_.joinable()) {
      std::unique_lock lock(mutex_);
      released_ = frame;
      changed_.notify_all();
      changed_.wait(lock, [&] { return made_ > frame; });
    } else {
      make_frames(frame, std::min(frame + kChunkFrames, frame_count_));
    }
  }
  return slot_of(frame);
}

void TargetStream::make_chunks() {
  for (int begin = 0; begin < frame_count_; begin += kChunkFrames) {
    const int end = std::min(begin + kChunkFrames, frame_count_);
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stop_ || end - released_ <= kChunkFrames * kChunks; });
      if (stop_) return;
    }
    make_frames(begin, end);
    {
      const std::lock_guard lock(mutex_);
      made_ = end;
    }
    changed_.notify_all();
  }
}

void TargetStream::make_frames(int begin, int end) {
  for (int frame = begin; frame < end; ++frame) {
    human_(frame, world_from_bone_);
    targets_.build(world_from_bone_, slot_of(frame));
  }
}

std::span<Pose> TargetStream::slot_of(int frame) {
  const auto count = static_cast<std::size_t>(targets_.target_count());
  const auto slot = static_cast<std::size_t>(frame % (kChunkFrames * kChunks));
  return std::span<Pose>(ring_).subspan(slot * count, count);
}

namespace {

// Largest share of the previous error that a better configuration may have.
constexpr double kBetterBranch = 0.98;

void keep_quaternion_sign(std::span<const double> before, std::span<double> now) {
  constexpr int kRootRotation = 3;
  align_sign(Eigen::Map<const Eigen::Vector4d>(before.data() + kRootRotation),
             Eigen::Map<Eigen::Vector4d>(now.data() + kRootRotation));
}

// Solves one clip.
class ClipSolver {
 public:
  ClipSolver(const std::shared_ptr<const Robot>& robot, const ResolvedConfig& config,
             const LimitSet& limits, const SolveFramesOptions& options)
      : robot_(robot), config_(config), limits_(limits), options_(options) {}

  Result<SolvedFrames> solve(const HumanClipInfo& human, HumanPoseSource poses) {
    TRY_ASSIGN(const TargetBuilder targets,
               make_targets(human, poses, *robot_, config_, options_.scale, options_.trunk));
    TargetStream stream(human.frame_count, std::move(poses), targets, options_.targets_ahead);
    return solve(targets, human.rate, human.frame_count, [&stream] { return stream.next(); });
  }

  /// @param next  returns the targets of each frame in order.
  Result<SolvedFrames> solve(const TargetBuilder& targets, const FrameRate& rate, int frames,
                             const std::function<std::span<const Pose>()>& next) {
    const auto problem = make_problem(robot_, config_, targets, limits_);
    solver_.emplace(problem, options_.engine, options_.ik);
    qpos_ = robot_->zero_configuration();
    find_axes_of_base();

    SolvedFrames result;
    frame_time_ = rate.frame_time();
    result.clip = RobotClip(robot_, rate, frames);
    ArmRecovery arms(*problem, targets);
    constexpr double kMaxBacktrack = 2.0;  // Seconds.
    kept_ = 1;
    if (options_.settle) {
      kept_ = std::clamp(static_cast<int>(kMaxBacktrack / frame_time_), 1, 1000);
    }
    recent_.resize(static_cast<std::size_t>(kept_));
    for (int frame = 0; frame < frames; ++frame) {
      if (options_.keep_going && !options_.keep_going(frame)) return interrupted_failure();
      const std::span<const Pose> world_from_target = next();
      if (options_.settle && needs_new_start(frame, world_from_target)) {
        branch_begin_ = frame;
        TRY(settle_from_starts(frame, world_from_target));
      }
      TRY(solve_frame(frame, world_from_target, result));
      if (options_.settle && arms.seen(qpos_, world_from_target)) {
        TRY(find_better_branch(frame, world_from_target, result));
      }
      if (frame + 1 >= kept_) report_frame(frame + 1 - kept_, result);
    }
    for (int frame = std::max(0, frames + 1 - kept_); frame < frames; ++frame) {
      report_frame(frame, result);
    }
    if (frames > 0) result.mean_error /= frames;
    return result;
  }

 private:
  // The body of the root bone may be another one than the base, such as the pelvis of a robot whose
  // base is the torso, and may have other axes.
  void find_axes_of_base() {
    const int body = config_.body_of(config_.root_bone);
    if (body < 0 || body == robot_->root_body() || robot_->fixed_base()) return;
    std::vector<Pose> world_from_body(robot_->bodies().size());
    forward_kinematics(*robot_, robot_->zero_configuration(), world_from_body);
    const auto rotation = [&](int of) {
      return world_from_body[static_cast<std::size_t>(of)].rotation;
    };
    root_from_base_ = rotation(body).conjugate() * rotation(robot_->root_body());
  }

  // Places the robot's base on the root's target.
  void place_root(std::span<const Pose> world_from_target) {
    if (robot_->fixed_base()) return;
    const Pose& pose = world_from_target.front();
    if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) return;
    std::ranges::copy(pose.translation, qpos_.begin());
    set_root_rotation(qpos_, (pose.rotation * root_from_base_).normalized());
  }

  // Returns true for the first frame and for frames in which the root's target rotates faster than
  // a body can. From the previous frame, the solver would then twist the trunk to its limits, where
  // it stays.
  [[nodiscard]] bool needs_new_start(int frame, std::span<const Pose> world_from_target) {
    constexpr double kMaxTurn = 1.0471975511965976;  // 60 degrees.
    constexpr double kMaxTurnRate = 20.0;            // Radians per second.
    const Eigen::Quaterniond before = root_target_;
    root_target_ = world_from_target.front().rotation.normalized();
    const Eigen::Quaterniond step = before.conjugate() * root_target_;
    const double turn = 2.0 * portable::atan2(step.vec().norm(), std::abs(step.w()));
    return frame == 0 || turn > std::max(kMaxTurn, kMaxTurnRate * frame_time_);
  }

  // Solves a frame from several starts and keeps the best result, because from a single start a
  // limb may reach its limits and stay there. Except in frame 0, the current configuration is the
  // first start.
  // @return whether a later start was clearly better than the first.
  Result<bool> settle_from_starts(int frame, std::span<const Pose> world_from_target) {
    constexpr double kClearlyBetter = 0.95;
    double min = std::numeric_limits<double>::infinity();
    std::vector<double> best;
    bool other = false;
    std::vector<std::vector<double>> all = starts();
    if (frame > 0) all.insert(all.begin(), qpos_);
    for (std::size_t i = 0; i < all.size(); ++i) {
      qpos_ = std::move(all[i]);
      place_root(world_from_target);
      TRY_ASSIGN(const double error, settle(frame, world_from_target));
      if (error < kClearlyBetter * min) {
        min = error;
        best = qpos_;
        other = i > 0;
      }
    }
    qpos_ = best;
    return other;
  }

  // Replaces the result of a solved frame by the current configuration.
  void replace_frame(int frame, double error, int steps, SolvedFrames& result) {
    double& known = recent(frame).error;
    result.steps += steps;
    result.mean_error += error - known;
    known = error;
    std::ranges::copy(qpos_, result.clip.qpos(frame).begin());
  }

  // Searches for a better configuration of a solved frame. Its branch replaces the frame, and the
  // frames before it as far back as it is better.
  Result<void> find_better_branch(int frame, std::span<const Pose> world_from_target,
                                  SolvedFrames& result) {
    const std::vector<double> before = qpos_;
    TRY_ASSIGN(const bool other, settle_from_starts(frame, world_from_target));
    if (!other) {
      qpos_ = before;
      return {};
    }
    double error = 0.0;
    TRY_ASSIGN(const int steps, solve_passes(frame, world_from_target, error));
    if (!(error < kBetterBranch * recent(frame).error)) {
      qpos_ = before;
      return {};
    }
    if (frame > 0) keep_quaternion_sign(result.clip.qpos(frame - 1), qpos_);
    replace_frame(frame, error, steps, result);
    TRY_ASSIGN(const int from, solve_backwards(frame, result));
    for (int changed = std::max(1, from); changed <= frame; ++changed) {
      keep_quaternion_sign(result.clip.qpos(changed - 1), result.clip.qpos(changed));
    }
    std::ranges::copy(result.clip.qpos(frame), qpos_.begin());
    branch_begin_ = frame;
    return {};
  }

  // Solves a frame repeatedly until the configuration stays constant. @return the remaining error.
  Result<double> settle(int frame, std::span<const Pose> world_from_target) {
    constexpr int kMaxRounds = 50;
    constexpr double kSettled = 1e-4;
    double error = 0.0;
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<double> before = qpos_;
      TRY(solve_passes(frame, world_from_target, error));
      double change = 0.0;
      for (std::size_t i = 0; i < qpos_.size(); ++i) {
        change = std::max(change, std::abs(qpos_[i] - before[i]));
      }
      if (change < kSettled) break;
    }
    return error;
  }

  // Start configurations: all joints at zero, the T-pose, the middle of the ranges.
  [[nodiscard]] std::vector<std::vector<double>> starts() const {
    std::vector<std::vector<double>> all(3, robot_->zero_configuration());
    for (std::size_t i = 0; i < robot_->joints().size(); ++i) {
      const RobotJoint& joint = robot_->joints()[i];
      const auto address = static_cast<std::size_t>(joint.qpos_address);
      const auto& t_pose = robot_->profile().t_pose;
      if (const auto found = t_pose.find(joint.name); found != t_pose.end()) {
        all[1][address] = found->second;
      }
      const double middle = 0.5 * (limits_.lower[i] + limits_.upper[i]);
      if (std::isfinite(middle)) all[2][address] = middle;
    }
    return all;
  }

  // Runs all passes over one frame.
  // @return the number of steps.
  Result<int> solve_passes(int frame, std::span<const Pose> world_from_target, double& error) {
    TRY_ASSIGN(const SolvedFrame solved,
               solver_->solve(world_from_target, qpos_, config_.file, frame));
    error = solved.error;
    return solved.steps;
  }

  Result<void> solve_frame(int frame, std::span<const Pose> world_from_target,
                           SolvedFrames& result) {
    double error = 0.0;
    TRY_ASSIGN(const int steps, solve_passes(frame, world_from_target, error));
    result.mean_error += error;
    if (options_.settle) {
      recent(frame).error = error;
      recent(frame).world_from_target.assign(world_from_target.begin(), world_from_target.end());
    }
    if (frame > 0) keep_quaternion_sign(result.clip.qpos(frame - 1), qpos_);
    std::ranges::copy(qpos_, result.clip.qpos(frame).begin());
    result.steps += steps;
    result.max_steps = std::max(result.max_steps, steps);
    return {};
  }

  // Solves backwards from a frame with a better configuration while that lowers the error.
  // @return the first frame that changed.
  Result<int> solve_backwards(int from, SolvedFrames& result) {
    int frame = from - 1;
    for (; frame > std::max(branch_begin_, from - kept_); --frame) {
      double error = 0.0;
      TRY_ASSIGN(const int steps, solve_passes(frame, recent(frame).world_from_target, error));
      if (!(error < kBetterBranch * recent(frame).error)) break;
      replace_frame(frame, error, steps, result);
    }
    return frame + 1;
  }

  void report_frame(int frame, const SolvedFrames& result) const {
    if (options_.frame_solved) options_.frame_solved(frame, result.clip.qpos(frame));
  }

  const std::shared_ptr<const Robot>& robot_;
  const ResolvedConfig& config_;
  const LimitSet& limits_;
  const SolveFramesOptions& options_;
  std::optional<FrameSolver> solver_;
  std::vector<double> qpos_;  // Configuration of the latest frame.
  // From the base to the body of the root bone in the zero configuration.
  Eigen::Quaterniond root_from_base_ = Eigen::Quaterniond::Identity();
  // The latest frames, which solve_backwards() may still change. They are reported once final.
  struct Recent {
    double error = 0.0;
    std::vector<Pose> world_from_target;
  };
  [[nodiscard]] Recent& recent(int frame) {
    return recent_[static_cast<std::size_t>(frame) % recent_.size()];
  }
  std::vector<Recent> recent_;
  int kept_ = 1;  // Number of these frames.
  // First frame of the current branch; solve_backwards() changes no frame up to it.
  int branch_begin_ = 0;
  double frame_time_ = 0.0;
  Eigen::Quaterniond root_target_ = Eigen::Quaterniond::Identity();  // Of the latest frame.
};

}  // namespace

Result<SolvedFrames> solve_frames(const HumanClip& human, const std::shared_ptr<const Robot>& robot,
                                  const ResolvedConfig& config, const LimitSet& limits,
                                  const SolveFramesOptions& options) {
  return ClipSolver(robot, config, limits, options).solve(human, poses_of(human));
}

Result<SolvedFrames> solve_frames(const Clip& clip, const Calibration& calibration,
                                  const std::shared_ptr<const Robot>& robot,
                                  const ResolvedConfig& config, const LimitSet& limits,
                                  const SolveFramesOptions& options) {
  HumanPoser poser(clip, calibration);
  return located(ClipSolver(robot, config, limits, options).solve(poser.info(), poses_of(poser)),
                 clip.name());
}

Result<SolvedFrames> solve_frames(const MadeTargets& made,
                                  const std::shared_ptr<const Robot>& robot,
                                  const ResolvedConfig& config, const LimitSet& limits,
                                  const SolveFramesOptions& options) {
  const auto count = static_cast<std::size_t>(made.targets.target_count());
  const auto frames = static_cast<int>(made.world_from_target.size() / count);
  return ClipSolver(robot, config, limits, options)
      .solve(made.targets, made.rate, frames, [&made, count, frame = std::size_t{0}]() mutable {
        return std::span(made.world_from_target).subspan(count * frame++, count);
      });
}

}  // namespace retarget
