#include "quality/lying.h"

#include <cmath>
#include <numbers>

#include "human/human_clip.h"
#include "human/source_feet.h"
#include "pipeline/trunk_lines.h"
#include "quality/trunk_lean.h"

namespace retarget {
namespace {

// who bends over to the floor keeps the hips higher, who sits keeps the trunk more upright; on hands
// and knees hips are at 0.6 of the legs
constexpr double kLyingLean = 60.0 * std::numbers::pi / 180.0;
constexpr double kLowHips = 0.75;  // of thigh and shank

}  // namespace

void measure_lying(const ReportBuilder& draft, const HumanClip& human, int frames) {
  const auto standing = standing_trunk(human);
  const double leg = leg_length(human);
  if (!standing || !(leg > 0.0) || frames == 0) return;
  int lying = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const HumanPose& pose = human.frame(frame);
    const auto trunk = trunk_frame(trunk_lines(pose));
    if (!trunk || pose[Bone::kHips].translation.z() >= kLowHips * leg) continue;
    const double upright = trunk_up(*trunk, *standing).z();
    if (upright < std::cos(kLyingLean)) ++lying;
  }
  draft.set("lying_pct", percent(lying, frames));
}

}  // namespace retarget
