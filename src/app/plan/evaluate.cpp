#include <filesystem>
#include <string>

#include "base/try.h"
#include "human/skeleton/human_clip.h"
#include "retarget/check_options.h"
#include "retarget/human.h"
#include "retarget/measure.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/normalize_start.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/solve.h"

namespace retarget {

namespace fs = std::filesystem;

Result<QualityReport> evaluate(const Motion& motion, bool dynamics) {
  const Plan& plan = motion.plan;
  TRY_ASSIGN(const Gates gates, default_gates(plan.robot.data_folder));
  // Measure the values that a file would contain, with their limited precision.
  RobotClip moved = motion.clip;
  if (plan.options.save.normalize_start) normalize_start(moved);
  TRY_ASSIGN(const RobotClip printed, printed_clip(moved, plan.options.save.precision));
  const HumanClip human = to_human(*motion.source, plan.human.calibration);
  const QualitySource source{&human, &plan.config, plan.scale};
  QualityReport report = measure_quality(printed, plan.limits, &source);
  add_hands(printed, *motion.source, plan.human.map, report);
  if (dynamics) add_dynamics(printed, report);
  add_solver_failures(motion.solver_failures, report);
  report.source = fs::path(motion.source->name()).filename().string();
  report.config = recorded_name(plan.config.file, plan.robot.data_folder);
  report.travel = plan.travel;
  report.fit = motion.fit;
  gates.judge(report);
  return report;
}

Result<QualityReport> evaluate(const Motion& motion) {
  return evaluate(motion, false);
}

}  // namespace retarget
