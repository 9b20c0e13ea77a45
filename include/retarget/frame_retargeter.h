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

/// Options of FrameRetargeter.
struct FrameRetargeterOptions {
  /// Height of the human, metres. Its ratio to the configuration's human_height_assumption
  /// multiplies all scales. Empty: the scales of the configuration.
  std::optional<double> human_height;
  double damping = 0.5;      ///< Added to the Hessian's diagonal for every degree of freedom; > 0.
  int max_extra_steps = 10;  ///< Maximum number of steps of a pass after its first step, 0 to 30.
  IkEngine engine = IkEngine::kFast;
};

/// Translation of all targets before solving.
struct TargetShift {
  double down = 0.0;  ///< Downward shift, metres.
  /// Afterwards, shifts the targets so that the lowest body with `foot` or `Foot` in its name is
  /// 0.1 m above the ground.
  bool to_ground = false;
};

/// Runs the published method one frame at a time, as in a live loop. Each frame starts from the
/// previous solution, the first from the robot's zero configuration. The results equal those of
/// solve_frames for a clip.
///
/// Use an object from one thread at a time. No memory is allocated per frame.
class FrameRetargeter {
 public:
  /// Creates a retargeter.
  /// Errors (kUsage): a height, damping or number of steps out of range.
  [[nodiscard]] static Result<FrameRetargeter> make(std::shared_ptr<const Robot> robot,
                                                    HumanConfig config, const LimitSet& limits,
                                                    const FrameRetargeterOptions& options = {});
  ~FrameRetargeter();
  FrameRetargeter(FrameRetargeter&&) noexcept;
  FrameRetargeter& operator=(FrameRetargeter&&) noexcept;

  [[nodiscard]] const Robot& robot() const;
  /// The human's bodies, in the order of update_targets.
  [[nodiscard]] const std::vector<std::string>& human_bodies() const;
  /// Indices into human_bodies() of the bodies with targets, the root first. update_targets() reads
  /// only their poses.
  [[nodiscard]] const std::vector<int>& target_bodies() const;

  /// Computes the targets of a human frame by scaling and offsets.
  ///
  /// Errors (kInput) name the body and leave the targets unchanged: non-finite values, a zero
  /// quaternion, no foot to put on the ground.
  /// @param world_from_body  one per human body, metres, Z up; rotations need not have unit norm.
  [[nodiscard]] Result<void> update_targets(std::span<const Pose> world_from_body,
                                            const TargetShift& shift = {});
  /// Target poses, one per target body, metres; empty before the first update_targets.
  [[nodiscard]] std::span<const Pose> world_from_target() const;

  /// Runs all passes towards the targets, starting from qpos().
  ///
  /// Errors leave the configuration unchanged: no targets yet (kUsage); positions too large for the
  /// computation (kInput); weights that produce non-finite values (kConfig).
  [[nodiscard]] Result<void> solve();

  /// The robot's configuration: root position (metres), root quaternion (w x y z), joints (rad, m).
  [[nodiscard]] std::span<const double> qpos() const;
  /// Sets the configuration from which the next frame starts. The quaternion is normalised.
  /// Errors (kUsage): a wrong number of values, non-finite values, a zero quaternion.
  [[nodiscard]] Result<void> set_qpos(std::span<const double> qpos);

  /// Norm of the stacked, unweighted six-vector errors of a table's tasks at the current
  /// configuration. Errors (kUsage): no targets yet; an unused table.
  /// @param table  1 or 2.
  [[nodiscard]] Result<double> error(int table);

 private:
  class Impl;
  explicit FrameRetargeter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
