#include "human/gait/root_jitter.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "human/gait/body_joint.h"
#include "human/gait/track_noise.h"
#include "retarget/human_skeleton.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// At lower rates, the steps of a run can look like independent errors. Seconds per frame.
constexpr double kLongestFrame = 1.0 / 22.0;

bool is_noisy(const TrackNoise& noise, double least, bool white, double frame_time) {
  if (noise.alternates()) return false;
  if (white) return noise.may_exceed(least);
  return frame_time < kLongestFrame && noise.exceeds(least) && has_white_noise({noise});
}

// Positions of the hips in the file's world and unit. Several joints above them may move.
std::vector<Vector3d> path_of_hips(const Clip& clip, FrameRange part, int hips) {
  const Skeleton& skeleton = clip.skeleton();
  std::vector<Vector3d> path;
  for (int frame = part.begin; frame < part.end; ++frame) {
    Vector3d place = clip.translation(frame, hips);
    for (int joint = skeleton.joint(hips).parent; joint >= 0;
         joint = skeleton.joint(joint).parent) {
      const auto& rotation = clip.rotations(frame)[static_cast<std::size_t>(joint)];
      place = clip.translation(frame, joint) + rotation * place;
    }
    path.push_back(place);
  }
  return path;
}

// By how far the steps of the path that exceed a limit have moved it. Smoothing would spread such
// jumps, and hide them from their warning.
std::vector<Vector3d> sum_of_jumps(const std::vector<Vector3d>& path, double limit) {
  std::vector<Vector3d> jumps = {Vector3d::Zero()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vector3d step = path[i] - path[i - 1];
    jumps.push_back(jumps.back());
    if (step.norm() > limit) jumps.back() += step;
  }
  return jumps;
}

}  // namespace

std::optional<RootJitter> smooth_root_jitter(Clip& clip, FrameRange part,
                                             const Calibration& calibration, bool white) {
  constexpr double kStep = 0.002, kSlowest = 1.5;  // Metres per frame, Hz.
  // Steps that neither a body nor its noise makes: m/s, and steps of the noise.
  constexpr double kFastest = 10.0, kRarely = 5.0;
  const int moved = body_joint(clip.skeleton(), calibration);
  if (moved < 0) return std::nullopt;
  std::vector<Vector3d> path =
      path_of_hips(clip, part, calibration.bones[Bone::kHips].position_joint);
  const TrackNoise noise = measure_noise(path);
  const double metres = calibration.metres_per_unit, frame_time = clip.rate().frame_time();
  if (!is_noisy(noise, kStep / metres, white, frame_time)) return std::nullopt;
  const std::vector<Vector3d> jumps =
      sum_of_jumps(path, std::max(kFastest * frame_time / metres, kRarely * noise.step));
  for (std::size_t i = 0; i < path.size(); ++i) path[i] -= jumps[i];
  const auto cutoff = best_cutoff(path, NoisePower::of(noise, true), frame_time, kSlowest);
  if (!cutoff) return std::nullopt;
  const auto smooth = smoothed(path, smoothing_strength(*cutoff, frame_time));
  for (int frame = part.begin; frame < part.end; ++frame) {
    const auto i = static_cast<std::size_t>(frame - part.begin);
    move_body(clip, frame, calibration, moved,
              metres * (calibration.human_from_source * (smooth[i] - path[i])));
  }
  return RootJitter{metres * noise.step, *cutoff};
}

}  // namespace retarget
