#include "judge/quality/posture.h"

#include <algorithm>
#include <cmath>

#include "human/gait/source_feet.h"
#include "judge/quality/report_parts.h"
#include "judge/quality/similarity_metrics.h"
#include "retarget/human.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {
namespace {

// Both conditions must hold in a frame in which the body lies or crawls: a person who bends to the
// floor has higher hips, and a person who sits has a more upright trunk. On hands and knees, the
// hips are at 0.6 of the leg length.
constexpr double kLyingUpright = 0.5;  // Largest cosine of the trunk's lean: 60 degrees.
constexpr double kLowHips = 0.75;      // Largest height of the hips, fraction of the leg length.
constexpr double kGettingUp = 0.5;     // Seconds before and after such a frame.

}  // namespace

Posture upright_posture(int frames) {
  return {std::vector<char>(static_cast<std::size_t>(frames), 1), std::nullopt, 0.0};
}

Posture find_posture(const HumanClip& human, int frames, int source_frames, double floor,
                     const SceneWorld* scene) {
  Posture posture = upright_posture(frames);
  posture.floor = floor;
  const auto standing = standing_trunk(human);
  const double leg = leg_length(human);
  if (!standing || !(leg > 0.0) || source_frames == 0) return posture;
  const int margin = static_cast<int>(std::lround(kGettingUp / human.rate.frame_time()));
  const auto height = [&](int frame, const Eigen::Vector3d& hips) {
    const bool in_scene = scene != nullptr && frame < scene->clip.frame_count;
    return hips.z() - (in_scene ? scene->ground_below(frame, hips) : floor);
  };
  int lying = 0;
  for (int frame = 0; frame < source_frames; ++frame) {
    const HumanPose& pose = human.frame(frame);
    const auto trunk = trunk_frame(trunk_lines(pose));
    if (!trunk || height(frame, pose[Bone::kHips].translation) >= kLowHips * leg) continue;
    if (trunk_up(*trunk, *standing).z() >= kLyingUpright) continue;
    ++lying;
    std::fill(posture.upright.begin() + std::max(frame - margin, 0),
              posture.upright.begin() + std::min(frame + margin + 1, frames), char{0});
  }
  posture.lying_pct = percent(lying, source_frames);
  return posture;
}

}  // namespace retarget
