#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/plan.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/fit_setup.h"
#include "solve/targets/frame_solver.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Makes targets for a human pose and solves for them with the two passes. Each frame starts from
/// the previous solution, the first one from the robot's zero configuration.
class OnlineTargets {
 public:
  /// Errors: those of make_targets.
  [[nodiscard]] static Result<std::unique_ptr<OnlineTargets>> make(const Plan& plan);

  /// Makes the targets of a human pose; the caller may change them before solve().
  void build(const HumanPose& world_from_bone);
  [[nodiscard]] std::span<Pose> world_from_target() { return world_from_target_; }
  /// Runs both passes. Returns false if these targets cannot be solved; the state is then
  /// unchanged.
  [[nodiscard]] bool solve();
  /// Makes the next solve() try several starts and keep the best, because the previous frame is no
  /// useful start. This takes milliseconds and allocates.
  void settle_next() { settles_ = as_fit_; }

  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }
  /// Translation added to the robot's position so that it moves as far as its feet do.
  [[nodiscard]] const Eigen::Vector3d& path() const { return path_; }
  [[nodiscard]] const HumanClipInfo& human() const { return human_; }
  /// The robot model of the fit, and the fit's options.
  [[nodiscard]] const FitModel& model() const { return model_; }
  [[nodiscard]] const FitOptions& options() const { return options_; }
  [[nodiscard]] const LimitSet& limits() const { return limits_; }
  [[nodiscard]] const Robot& robot() const { return *robot_; }
  /// Scale of the robot's foot paths relative to the human's.
  [[nodiscard]] double foot_scale() const { return scales_.foot; }

 private:
  OnlineTargets(const Plan& plan, const HumanClipInfo& human, TargetBuilder targets);
  bool settle();

  bool as_fit_;  // Follow the fit instead of the published method.
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
