#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "human/gait/contact_plan.h"
#include "human/gait/source_feet.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/plan.h"
#include "retarget/pose.h"
#include "solve/fit/clip_fitter.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/fit_setup.h"
#include "solve/targets/frame_solver.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Makes the targets of a human pose and solves them with the published passes. A frame starts from
/// the previous solution, the first frame from the robot's zero configuration.
class OnlineTargets {
 public:
  /// Errors: those of make_targets.
  /// @param plan  plan with a clip, which determines the limb lengths.
  [[nodiscard]] static Result<std::unique_ptr<OnlineTargets>> make(const Plan& plan);

  /// Makes the targets of a human pose; the caller may change them before solve().
  void build(const HumanPose& world_from_bone);
  [[nodiscard]] std::span<Pose> world_from_target() { return world_from_target_; }
  /// Runs the passes. @return false if the targets cannot be solved; the state is then unchanged.
  [[nodiscard]] bool solve();
  /// Makes the next solve() try several starts and keep the best result, after a discontinuity.
  /// This takes milliseconds and allocates. Has an effect only for Method::kFit.
  void settle_next() { settles_ = as_fit_; }

  /// The solution, laid out as in RobotClip, without path().
  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }
  /// Translation to add to the robot's position so that it travels at the scale of its feet;
  /// metres.
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

  bool as_fit_;  // Whether the targets are those of the fit instead of the published method.
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

/// Runs the fit of whole clips on a moving window of a stream's latest frames (fixed-lag
/// smoothing). Each new frame triggers a few solver steps. A frame leaves the window at a fixed age
/// and is then a boundary condition of the following frames.
class LagFit {
 public:
  /// @param stage       provides the model and the options of the fit; must outlive this object.
  /// @param frame_time  seconds.
  /// @param lag_frames  number of newer frames after which a frame leaves the window.
  LagFit(const OnlineTargets& stage, double frame_time, int lag_frames);

  /// Adds the next frame, as solved by the stage.
  /// @param floor  height of the floor, metres above the source's origin.
  void push(const HumanPose& world_from_bone, std::span<const Pose> world_from_target,
            std::span<const double> qpos, const Eigen::Vector3d& path, double floor);
  /// Ends the stream: takes as many steps over the remaining frames as the fit of a clip.
  void finish();
  /// Discards all frames, for a discontinuity.
  void restart();

  /// Whether next() has a frame: one that is old enough or, after finish(), any remaining frame.
  [[nodiscard]] bool has_next() const {
    return sent_ < clip_.frame_count - (finished_ ? 0 : lag_frames_);
  }
  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_finished() const { return finished_; }
  /// Number of steps since the last call of this function that were discarded because of non-finite
  /// values.
  [[nodiscard]] int take_failed_steps() { return std::exchange(failed_steps_, 0); }
  /// Removes the oldest frame from the window and returns its configuration, valid until the next
  /// call. @pre has_next()
  [[nodiscard]] std::span<const double> next();

 private:
  void take_steps(int count);
  void forget_old_frames();
  void lower_targets(double floor);
  void start_frame(std::span<const double> qpos, const Eigen::Vector3d& path);
  void reserve();
  void plan_contacts();
  void keep_anchors();
  [[nodiscard]] Eigen::Vector2d kept_anchor(int old_index, const PlantedPhase& phase) const;
  [[nodiscard]] Eigen::Vector2d place_of(const PlantedPhase& phase);
  [[nodiscard]] int window_begin() const { return sent_; }

  const OnlineTargets& stage_;
  const FitModel& model_;
  FitOptions options_;  // Those of the stage, adapted to the length of the window.
  int lag_frames_;
  int kept_frames_;  // Number of sent frames after a cleanup, which happens at twice as many.
  int steps_ = 1;    // Solver steps every turn_ frames.
  int turn_ = 1;
  int wait_ = 0;
  std::vector<int> source_feet_;
  FitClip clip_;
  SourceFeet feet_;
  ContactPlanner planner_;
  std::vector<PlantedPhase> old_phases_;  // Phases of the previous contact plan.
  std::vector<Eigen::Vector2d> old_anchors_;
  std::vector<SupportGoal> old_supports_;
  std::unique_ptr<MovingFit> fit_;
  TreeState pose_;
  double floor_ = 0.0;  // Floor height of the frames in the window.
  int sent_ = 0;        // Number of clip_'s frames that have left the window.
  int forgotten_ = 0;   // Number of frames erased from clip_ since the window last moved.
  int failed_steps_ = 0;
  bool finished_ = false;
};

}  // namespace retarget
