#include "human/gait/clean_positions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "formats/smpl/joint_motion.h"
#include "human/gait/track_noise.h"
#include "human/skeleton/joint_clip.h"
#include "retarget/clip.h"
#include "retarget/statistics.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// World positions, indexed by joint and frame.
std::vector<std::vector<Vector3d>> position_tracks(const Clip& clip) {
  const auto joints = static_cast<std::size_t>(clip.skeleton().joint_count());
  std::vector<std::vector<Vector3d>> tracks(joints);
  std::vector<Pose> world(joints);
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    for (std::size_t joint = 0; joint < joints; ++joint) {
      tracks[joint].push_back(world[joint].translation);
    }
  }
  return tracks;
}

// Longest side of the body's axis-aligned bounding box, median over the frames.
double body_extent(const std::vector<std::vector<Vector3d>>& tracks) {
  std::vector<double> extents;
  for (std::size_t frame = 0; frame < tracks.front().size(); ++frame) {
    Eigen::AlignedBox3d box;
    for (const auto& track : tracks) box.extend(track[frame]);
    extents.push_back(box.sizes().maxCoeff());
  }
  return median(extents);
}

JointMotion motion_of(const Clip& clip, const std::vector<std::vector<Vector3d>>& tracks) {
  JointMotion motion;
  motion.frame_count = clip.frame_count();
  motion.joint_count = clip.skeleton().joint_count();
  motion.names = clip.skeleton().names();
  motion.rate = clip.rate();
  motion.height = clip.origin().body_height;
  for (std::size_t frame = 0; frame < tracks.front().size(); ++frame) {
    for (const auto& track : tracks) motion.positions.push_back(track[frame]);
  }
  return motion;
}

}  // namespace

std::string clean_positions(Clip& clip) {
  constexpr double kStep = 0.003;   // Share of the body's extent.
  constexpr double kSlowest = 2.0;  // Hz
  if (clip.origin().unknown_rotations.empty() || clip.frame_count() == 0) return {};
  std::vector<std::vector<Vector3d>> tracks = position_tracks(clip);
  const double extent = body_extent(tracks), frame_time = clip.rate().frame_time();
  std::vector<double> steps;
  std::vector<TrackNoise> noises;
  for (const auto& track : tracks) {
    noises.push_back(measure_noise(track, frame_time));
    if (noises.back().exceeds(kStep * extent)) steps.push_back(noises.back().step);
  }
  if (2 * steps.size() < tracks.size()) return {};
  for (std::size_t joint = 0; joint < tracks.size(); ++joint) {
    if (!noises[joint].may_exceed(0.0)) continue;
    const double cutoff = cutoff_for(noises[joint], frame_time, kSlowest);
    tracks[joint] = smoothed(tracks[joint], cutoff, frame_time);
  }
  auto remade = clip_of_joints(motion_of(clip, tracks), clip.name());
  // The bone map refers to joints by index, so their order must not change.
  if (!remade || remade->skeleton().names() != clip.skeleton().names()) return {};
  remade->set_origin(clip.origin());
  clip = *std::move(remade);
  return fmt::format("jitter of {} % of the body size per frame (median of {} of {}) smoothed",
                     number_text(100.0 * median(steps) / extent, 1), steps.size(),
                     count_text(tracks.size(), "joint"));
}

}  // namespace retarget
