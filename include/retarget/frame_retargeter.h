#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// How frames are retargeted one at a time.
struct FrameRetargeterOptions {
  /// Of the human, metres: scales are multiplied by its ratio to the configuration's
  /// human_height_assumption. Empty: they stay as they are.
  std::optional<double> human_height;
  double damping = 0.5;      ///< Of every degree of freedom in a step.
  int max_extra_steps = 10;  ///< Of a pass after its first one, at most 30.
  IkEngine engine = IkEngine::kFast;
};

/// Where targets are moved before they are solved.
struct TargetShift {
  double down = 0.0;  ///< Metres.
  /// After that, the lowest body with `foot` or `Foot` in its name comes to 0.1 m over the ground.
  bool to_ground = false;
};

/// The published method one frame at a time, as in a live loop: each frame starts from the one
/// before, the first from the robot's zero configuration. Gives what solve_frames gives for a clip.
///
/// One object belongs to one thread at a time. Nothing is allocated per frame.
class FrameRetargeter {
 public:
  /// Errors: a height, damping or number of steps out of range (kUsage).
  [[nodiscard]] static Result<FrameRetargeter> make(std::shared_ptr<const Robot> robot,
                                                    HumanConfig config, const LimitSet& limits,
                                                    const FrameRetargeterOptions& options = {});
  ~FrameRetargeter();
  FrameRetargeter(FrameRetargeter&&) noexcept;
  FrameRetargeter& operator=(FrameRetargeter&&) noexcept;

  [[nodiscard]] const Robot& robot() const;
  /// The human's bodies, in the order of update_targets.
  [[nodiscard]] const std::vector<std::string>& human_bodies() const;
  /// Indices into human_bodies() of the bodies that targets are made from, the root first. The
  /// others' poses are not read.
  [[nodiscard]] const std::vector<int>& target_bodies() const;

  /// Scales and offsets a frame of the human to targets.
  ///
  /// Errors (kInput) name the body, and the targets stay as they were: values that are not finite,
  /// a rotation without length, no foot to bring to the ground.
  /// @param world_from_body  one per human body, metres, Z up; rotations need not have unit norm.
  [[nodiscard]] Result<void> update_targets(std::span<const Pose> world_from_body,
                                            const TargetShift& shift = {});
  /// One per target body, metres; empty before the first update_targets.
  [[nodiscard]] std::span<const Pose> world_from_target() const;

  /// Solves both passes towards the targets.
  ///
  /// Errors, after which the configuration is the one before: no targets yet (kUsage); positions too
  /// large to compute with (kInput); weights that lead to values that are not finite (kConfig).
  [[nodiscard]] Result<void> solve();

  /// The robot's configuration: root position (metres), root quaternion (w x y z), joints (rad, m).
  [[nodiscard]] std::span<const double> qpos() const;
  /// Where the next frame starts. The quaternion is normalised.
  /// Errors (kUsage): another number of values, values that are not finite, a quaternion of zeros.
  [[nodiscard]] Result<void> set_qpos(std::span<const double> qpos);

  /// Norm of the stacked six-vector errors of a table's tasks in the present configuration, without
  /// weights. Errors (kUsage): no targets yet; a table that is not used.
  /// @param table  1 or 2.
  [[nodiscard]] Result<double> error(int table);

 private:
  class Impl;
  explicit FrameRetargeter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
