#pragma once

#include <optional>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/measure.h"
#include "retarget/motion.h"
#include "retarget/robot.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Estimates the joint positions that the human's pose demands. The demand on a joint is the
/// rotation about its axis that gives the next bodies with a target the same rotation relative to
/// the previous body with a target as their targets have. Errors in other parts of the body, such
/// as a leaning pelvis, therefore have no effect.
class JointDemand {
 public:
  /// Keeps references to the clip and to the source's human.
  /// @param source  has a configuration and at least `frames` frames.
  JointDemand(const RobotClip& clip, const LimitSet& limits, const QualitySource& source,
              int frames);

  /// Whether the pose demands a position beyond the current one, or less than 0.02 rad before it.
  /// False if no target depends on the joint or the frame has no source. Keeps the robot's pose of
  /// the last frame, so that further joints of the same frame take less time.
  /// @param upper  whether `beyond` means greater.
  [[nodiscard]] bool reaches(int frame, int joint, bool upper);

 private:
  struct Target {
    int body = 0;
    int index = 0;  // Index of the pose in the built targets.
  };
  // The targets between which a joint turns: the last one towards the root, and the next ones
  // outwards.
  struct Span {
    Target before;
    std::vector<Target> beyond;
  };
  void find_spans(const Robot& robot, const std::vector<Target>& targets);
  [[nodiscard]] Eigen::Quaterniond world_from_target(int target);

  const RobotClip& clip_;
  const HumanClip* human_ = nullptr;
  int frames_ = 0;
  std::optional<TargetBuilder> targets_;
  std::vector<std::optional<Span>> spans_;  // One per joint.
  int frame_ = -1;                          // The last evaluated frame.
  TreeState posed_;
  bool has_trunk_ = false;  // Whether trunk_ is that of this frame.
  std::optional<TrunkAim::Aimed> trunk_;
};

}  // namespace retarget
