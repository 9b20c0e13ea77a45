#include "human/gait/centred_root.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "human/gait/body_joint.h"
#include "human/gait/source_feet.h"
#include "human/gait/standing_heights.h"
#include "human/gait/track_noise.h"
#include "retarget/human_poser.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kRestingHips = 5e-4;  // Metres; files round positions to less.
constexpr double kLeastChange = 0.01;  // Metres.
constexpr double kHipsCutoff = 4.0;    // Hz. The lowest part changes at once, but hips do not.

std::vector<double> distances_from_median(const std::vector<Vector3d>& track) {
  Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vector3d& place : track) values.push_back(place[axis]);
    middle[axis] = median(std::move(values));
  }
  std::vector<double> distances;
  for (const Vector3d& place : track) distances.push_back((place - middle).norm());
  return distances;
}

// Whether a point rests in the frames in which the legs are away from their usual pose. A recorded
// body that stands still for most of a clip moves there.
bool rests(const std::vector<Vector3d>& track, const std::vector<char>& legs_move) {
  constexpr std::size_t kFewestFrames = 3;
  const std::vector<double> all = distances_from_median(track);
  std::vector<double> distances;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (legs_move[i] != 0) distances.push_back(all[i]);
  }
  if (distances.size() < kFewestFrames) return false;
  // Interpolated frames may move the hips.
  return percentile(std::move(distances), 90.0) < kRestingHips;
}

// Whether the joint of the hips or the middle of the hip joints rests while the legs move.
bool root_rests(HumanPoser& poser, FrameRange part) {
  std::vector<Vector3d> hips, middle;
  std::array<std::vector<Vector3d>, 2> legs;  // Ends of the legs, relative to the hips.
  const HumanClipInfo info = poser.info();
  HumanPose pose;
  for (int frame = part.begin; frame < part.end; ++frame) {
    poser.pose(frame, pose);
    hips.push_back(pose[Bone::kHips].translation);
    middle.emplace_back(0.5 *
                        (pose[Bone::kLeftUpLeg].translation + pose[Bone::kRightUpLeg].translation));
    for (const std::size_t side : {0U, 1U}) {
      const Bone ankle = side_bone(kSides[side], LimbBone::kFoot);
      const Bone end = info.has(ankle) ? ankle : side_bone(kSides[side], LimbBone::kLeg);
      legs[side].push_back(pose[end].translation - hips.back());
    }
  }
  std::vector<char> legs_move(hips.size());
  for (const std::vector<Vector3d>& leg : legs) {
    const std::vector<double> distances = distances_from_median(leg);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      if (distances[i] > kLeastChange) legs_move[i] = 1;
    }
  }
  return rests(hips, legs_move) || rests(middle, legs_move);
}

}  // namespace

std::optional<double> restore_centred_height(Clip& clip, FrameRange part,
                                             const Calibration& calibration) {
  HumanPoser poser(clip, calibration);
  const HumanClipInfo info = poser.info();
  const int moved = body_joint(clip.skeleton(), calibration);
  if (moved < 0 || !info.has(Bone::kHips) || !info.has(Bone::kLeftUpLeg) ||
      !info.has(Bone::kRightUpLeg) || part.end - part.begin < 3 || !root_rests(poser, part)) {
    return std::nullopt;
  }
  const SourceFeet feet = feet_and_hips(clip, calibration, part).feet;
  if (feet.foot_count == 0) return std::nullopt;
  const double scale = feet.leg_length() / kUsualSourceLeg;
  std::vector<double> floors;
  std::vector<Vector3d> rises;
  for (int frame = 0; frame < feet.frame_count(); ++frame) {
    floors.push_back(floor_below_lowest(feet, frame, scale));
    rises.emplace_back(-floors.back() * Vector3d::UnitZ());
  }
  const auto [lowest, highest] = std::ranges::minmax(floors);
  if (!(highest - lowest > kLeastChange)) return std::nullopt;
  rises = smoothed(std::move(rises), smoothing_strength(kHipsCutoff, feet.frame_time));
  for (int frame = part.begin; frame < part.end; ++frame) {
    move_body(clip, frame, calibration, moved, rises[static_cast<std::size_t>(frame - part.begin)]);
  }
  return highest - lowest;
}

}  // namespace retarget
