#include "judge/quality/source_slide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace retarget {

void measure_source_slide(const ReportBuilder& draft, const HumanClip& human, int frames) {
  // Long enough that capture noise has little influence.
  constexpr double kStepSeconds = 1.0 / 30.0;
  const double fps = human.rate.fps();
  const int step = std::max(1, static_cast<int>(std::lround(kStepSeconds * fps)));
  std::vector<Bone> feet;
  for (const Side side : kSides) {
    for (const LimbBone part : {LimbBone::kFoot, LimbBone::kToe}) {
      if (human.has(side_bone(side, part))) feet.push_back(side_bone(side, part));
    }
  }
  const bool has_hips = human.has(Bone::kLeftUpLeg) && human.has(Bone::kRightUpLeg);
  if (feet.empty() || !has_hips || frames <= step) return;
  double sum = 0.0;
  for (int frame = step; frame < frames; ++frame) {
    const HumanPose &before = human.frame(frame - step), &now = human.frame(frame);
    const auto way = [&](Bone bone) -> Eigen::Vector3d {
      return now[bone].translation - before[bone].translation;
    };
    double least = std::numeric_limits<double>::infinity();
    for (const Bone foot : feet) least = std::min(least, way(foot).norm());
    const Eigen::Vector3d hips = 0.5 * (way(Bone::kLeftUpLeg) + way(Bone::kRightUpLeg));
    sum += std::max(0.0, least - hips.norm()) * fps / step;
  }
  draft.set("source_slide_mean", sum / (frames - step));
}

}  // namespace retarget
