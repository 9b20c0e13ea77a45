#pragma once

#include <optional>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/measure.h"
#include "retarget/motion.h"
#include "retarget/pose.h"
#include "retarget/robot.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Finds the positions of single joints that the human's pose demands. Each turns the next body
/// with a target, relative to the body with a target before it, as their targets are turned to each
/// other. Errors elsewhere in the body, such as a pelvis that leans wrongly, therefore have
/// no influence.
class JointDemand {
 public:
  /// @param source  with a configuration, at least as long as `frames`; refers to it.
  JointDemand(const RobotClip& clip, const LimitSet& limits, const QualitySource& source,
              int frames);

  /// Returns whether the pose demands a position beyond the current one, or nearly the current one.
  /// False if no target depends on the joint or the frame has no source.
  /// @param upper  whether beyond means greater.
  [[nodiscard]] bool reaches(int frame, int joint, bool upper) const;

 private:
  struct Target {
    int body = 0;
    int index = 0;  // Index of the pose in the built targets.
  };
  // The bodies between which a joint turns.
  struct Span {
    Target before;
    std::vector<Target> beyond;
  };
  void find_spans(const Robot& robot, const std::vector<Target>& targets);

  const RobotClip& clip_;
  const HumanClip* human_ = nullptr;
  int frames_ = 0;
  std::optional<TargetBuilder> targets_;
  std::vector<std::optional<Span>> spans_;  // By joint.
  // The most recently evaluated frame.
  mutable int frame_ = -1;
  mutable std::optional<TreeState> posed_;
  mutable std::vector<Pose> world_from_target_;
};

}  // namespace retarget
