#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fit/fit_model.h"
#include "fit/fit_setup.h"
#include "human/human_clip.h"
#include "pipeline/frame_solver.h"
#include "pipeline/targets.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/plan.h"

namespace retarget {

/// What a stream asks of the robot: targets for a human, and the two passes towards them. Each frame
/// begins where the one before ended, the first from the robot's zero configuration.
class LiveTargets {
 public:
  /// Errors: make_targets'.
  [[nodiscard]] static Result<std::unique_ptr<LiveTargets>> make(const Plan& plan);

  /// Makes the targets of a human; they may be changed before they are solved.
  void build(const HumanPose& world_from_bone);
  [[nodiscard]] std::span<Pose> world_from_target() { return world_from_target_; }
  /// Both passes; false: these targets cannot be solved, and all is as before.
  [[nodiscard]] bool solve();
  /// Looks for the best of several ways to begin at the next solve: where the frame before says
  /// nothing. Takes milliseconds, and memory.
  void settle_next() { settles_ = as_fit_; }

  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }
  /// What is added to the robot's place so that it goes as its feet go.
  [[nodiscard]] const Eigen::Vector3d& path() const { return path_; }
  [[nodiscard]] const HumanClipInfo& human() const { return human_; }
  /// The robot as fits see it, and how they weigh.
  [[nodiscard]] const FitModel& model() const { return model_; }
  [[nodiscard]] const FitOptions& options() const { return options_; }
  [[nodiscard]] const LimitSet& limits() const { return limits_; }
  [[nodiscard]] const Robot& robot() const { return *robot_; }
  /// Of the robot's foot paths against the human's.
  [[nodiscard]] double foot_scale() const { return scales_.foot; }

 private:
  LiveTargets(const Plan& plan, const HumanClipInfo& human, TargetBuilder targets);
  bool settle();

  bool as_fit_;  // not as the published method
  IkEngine engine_;
  std::shared_ptr<const Robot> robot_;
  ResolvedConfig config_;
  LimitSet limits_, solver_limits_;
  HumanClipInfo human_;
  TargetBuilder targets_;
  FitOptions options_;
  FitModel model_;
  PathScales scales_;
  FrameSolver solver_;
  std::vector<Pose> world_from_target_;
  std::vector<double> qpos_, before_;
  Eigen::Vector3d path_ = Eigen::Vector3d::Zero();
  bool settles_ = false;
};

}  // namespace retarget
