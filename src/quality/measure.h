#pragma once

#include <cstddef>
#include <string>

#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// The movement that a robot's motion came from. Frame i of both is the same instant.
struct QualitySource {
  const HumanClip* human = nullptr;  ///< At the motion's rate; may be longer or shorter.
  const ResolvedConfig* config =
      nullptr;  ///< Whose targets are tracked; nullptr: tracking is left out.
  /// How the targets were scaled.
  ScaleRule scale = ScaleRule::kTable;
};

struct QualityOptions {
  /// self_1cm_pct and self_max_cm look at every so-manieth frame, by MuJoCo's contact depths.
  int self_collision_stride = 5;
  std::size_t faults_per_metric = 10;
};

/// Measures a motion; docs/quality.md and quality_metrics() define what.
/// @param limits  the set that limit_pct is about; all sets of the robot are reported as well.
/// @param source  without one, what needs it is left out.
/// @pre the clip has frames
[[nodiscard]] QualityReport measure_quality(const RobotClip& clip, const LimitSet& limits,
                                            const QualitySource* source = nullptr,
                                            const QualityOptions& options = {});

/// Adds what a motion asks of its robot by inverse dynamics, and what contacts can supply of it; no
/// source has a say in it. Left out for a robot without mass, and for fewer than three frames.
void add_dynamics(const RobotClip& clip, QualityReport& report, const QualityOptions& options = {});

/// Adds how the robot's fingers follow the source's, where both have some (docs/hands.md).
/// @param source  whose frames are the motion's.
void add_hands(const RobotClip& clip, const Clip& source, const BoneMap& map,
               QualityReport& report);

}  // namespace retarget
