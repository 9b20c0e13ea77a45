#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "fit/clip_fitter.h"
#include "human/contact_planner.h"
#include "human/source_feet.h"
#include "live/live_targets.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// The fit of whole clips on the latest frames of a stream: a few steps for every frame that comes,
/// frames leave when they are old enough and are what the next ones begin with.
class LagFit {
 public:
  /// @param stage       outlives this; what it is asked for is fitted.
  /// @param lag_frames  how many frames come after a frame before it leaves.
  LagFit(const LiveTargets& stage, double frame_time, int lag_frames);

  /// Takes the next frame, as the stage has solved it.
  /// @param floor  height of the floor, metres above the source's origin.
  void push(const HumanPose& world_from_bone, std::span<const Pose> world_from_target,
            std::span<const double> qpos, const Eigen::Vector3d& path, double floor);
  /// No more frames come: the last steps of a clip's fit over those that are left.
  void finish();
  /// What comes next has nothing to do with what came before.
  void restart();

  /// Whether a frame is old enough to leave, or left over at the end.
  [[nodiscard]] bool has_next() const {
    return sent_ < clip_.frame_count - (finished_ ? 0 : lag_frames_);
  }
  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_finished() const { return finished_; }
  /// The next frame that leaves, valid until the next call. @pre has_next()
  [[nodiscard]] std::span<const double> next();

 private:
  void forget_old_frames();
  void lower_targets(double floor);
  void start_frame(std::span<const double> qpos, const Eigen::Vector3d& path);
  void reserve();
  void plan_contacts();
  void keep_anchors();
  [[nodiscard]] Eigen::Vector2d place_of(const PlantedPhase& phase);
  [[nodiscard]] int window_begin() const { return sent_; }

  const LiveTargets& stage_;
  const FitModel& model_;
  int lag_frames_;
  int kept_frames_;  // of those that left
  int steps_ = 1;    // of each turn
  int turn_ = 1;     // frames
  int wait_ = 0;
  std::vector<int> source_feet_;
  FitClip clip_;
  SourceFeet feet_;
  ContactPlanner planner_;
  std::vector<PlantedPhase> old_phases_;  // of the plan before
  std::vector<Eigen::Vector2d> old_anchors_;
  std::unique_ptr<MovingFit> fit_;
  TreeState pose_;
  double floor_ = 0.0;  // of the frames that have not left
  int sent_ = 0;        // frames of the clip that left
  int forgotten_ = 0;   // since the window moved last
  bool finished_ = false;
};

}  // namespace retarget
