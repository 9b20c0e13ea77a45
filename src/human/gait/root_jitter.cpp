#include "human/gait/root_jitter.h"

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "human/gait/body_joint.h"
#include "human/gait/track_noise.h"

namespace retarget {
namespace {

// At lower rates, the steps of a run can look like independent errors. Seconds per frame.
constexpr double kLongestFrame = 1.0 / 22.0;

bool is_noisy(const TrackNoise& noise, double least, bool white, double frame_time) {
  if (white) return noise.may_exceed(least);
  return frame_time < kLongestFrame && noise.exceeds(least) && has_white_noise({noise});
}

// Whether the path has a step that no body makes. Smoothing would spread it, and hide it from the
// warning of jumps.
bool has_jumps(const std::vector<Eigen::Vector3d>& path, double metres, double frame_time) {
  constexpr double kFastest = 10.0;  // m/s
  for (std::size_t i = 1; i < path.size(); ++i) {
    if (metres * (path[i] - path[i - 1]).norm() > kFastest * frame_time) return true;
  }
  return false;
}

}  // namespace

std::optional<RootJitter> smooth_root_jitter(Clip& clip, FrameRange part,
                                             const Calibration& calibration, bool white) {
  constexpr double kStep = 0.002, kSlowest = 1.5;  // Metres per frame, Hz.
  const int joint = body_joint(clip.skeleton(), calibration);
  if (joint < 0) return std::nullopt;
  std::vector<Eigen::Vector3d> path;
  for (int frame = part.begin; frame < part.end; ++frame) {
    path.push_back(clip.translation(frame, joint));
  }
  const TrackNoise noise = measure_noise(path);
  const double metres = calibration.metres_per_unit, frame_time = clip.rate().frame_time();
  if (has_jumps(path, metres, frame_time)) return std::nullopt;
  if (!is_noisy(noise, kStep / metres, white, frame_time)) return std::nullopt;
  const auto cutoff = best_cutoff(path, NoisePower::of(noise, true), frame_time, kSlowest);
  if (!cutoff) return std::nullopt;
  path = smoothed(path, smoothing_strength(*cutoff, frame_time));
  const auto slot = static_cast<std::size_t>(clip.skeleton().translation_slot(joint));
  for (int frame = part.begin; frame < part.end; ++frame) {
    clip.translations(frame)[slot] = path[static_cast<std::size_t>(frame - part.begin)];
  }
  return RootJitter{metres * noise.step, *cutoff};
}

}  // namespace retarget
