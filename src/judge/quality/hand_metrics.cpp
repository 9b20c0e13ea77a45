#include <algorithm>
#include <vector>

#include "base/math/statistics.h"
#include "judge/quality/draft.h"
#include "retarget/measure.h"
#include "solve/hands/hand_errors.h"

namespace retarget {

void add_hands(const RobotClip& clip, const Clip& source, const BoneMap& map,
               QualityReport& report) {
  HandErrors errors = measure_hands(source, map, clip);
  const QualityOptions options;
  const ReportBuilder draft{clip, options, report};
  for (double& angle : errors.angles) angle *= kDegreesPerRadian;
  for (double& gap : errors.touching_gaps) gap *= kInCm;
  if (!errors.angles.empty()) {
    draft.set("finger_angle_deg", mean(errors.angles), percentile(errors.angles, 95.0));
  }
  if (!errors.touching_gaps.empty()) {
    draft.set("touch_gap_cm", mean(errors.touching_gaps), percentile(errors.touching_gaps, 95.0));
  }
  std::ranges::sort(report.values, {}, &MetricValue::metric);
}

}  // namespace retarget
