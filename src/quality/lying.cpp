#include "quality/lying.h"

#include "human/human_clip.h"
#include "human/source_feet.h"
#include "pipeline/trunk_lines.h"
#include "quality/trunk_lean.h"

namespace retarget {
namespace {

// who bends over to the floor keeps the hips higher, who sits keeps the trunk more upright; on hands
// and knees hips are at 0.6 of the legs
constexpr double kLyingUpright = 0.5;  // the cosine of 60 degrees
constexpr double kLowHips = 0.75;      // of thigh and shank

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
    if (trunk_up(*trunk, *standing).z() < kLyingUpright) ++lying;
  }
  draft.set("lying_pct", percent(lying, frames));
}

}  // namespace retarget
