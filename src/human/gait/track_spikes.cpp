#include "human/gait/track_spikes.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <utility>

#include "human/gait/bridge_frames.h"
#include "retarget/so3.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kLongestSpike = 3, kAroundSpike = 3;  // Frames.
// Largest step around a spike, relative to its jumps.
constexpr double kStepShare = 0.35;

// Whether the frames of a gap are a spike.
// @param distance  of two frames
template <typename Distance>
bool is_spike(FrameRange part, FrameRange gap, double least, const Distance& distance) {
  const int before = gap.begin - 1, after = gap.end;
  const double jump = std::min(distance(before, gap.begin), distance(gap.end - 1, after));
  if (!(jump > least) || distance(before, after) > kStepShare * jump) return false;
  double around = 0.0;
  for (int frame = std::max(part.begin, before - kAroundSpike); frame < before; ++frame) {
    around = std::max(around, distance(frame, frame + 1));
  }
  const int last = std::min(part.end - 1, after + kAroundSpike);
  for (int frame = after; frame < last; ++frame) {
    around = std::max(around, distance(frame, frame + 1));
  }
  return around < kStepShare * jump;
}

// Calls bridge(gap) for each spike. @return number of frames of all spikes.
template <typename Distance, typename Bridge>
int bridge_spikes_of(FrameRange part, double least, const Distance& distance,
                     const Bridge& bridge) {
  int count = 0;
  for (int begin = part.begin + 1; begin + 1 < part.end; ++begin) {
    if (!(distance(begin - 1, begin) > least)) continue;
    for (int end = begin + 1; end < part.end && end <= begin + kLongestSpike; ++end) {
      if (!is_spike(part, {begin, end}, least, distance)) continue;
      bridge(FrameRange{begin, end});
      count += end - begin;
      break;
    }
  }
  return count;
}

int bridge_turns(Clip& clip, FrameRange part, std::size_t joint) {
  constexpr double kLeastTurn = std::numbers::pi / 6.0;
  const auto rotation = [&](int frame) -> const Quaterniond& {
    return std::as_const(clip).rotations(frame)[joint];
  };
  return bridge_spikes_of(
      part, kLeastTurn,
      [&](int a, int b) { return log_so3(rotation(a).conjugate() * rotation(b)).norm(); },
      [&](FrameRange gap) { bridge_rotations(clip, joint, gap); });
}

int bridge_moves(Clip& clip, FrameRange part, std::size_t slot, double metres_per_unit) {
  constexpr double kLeastMove = 0.15;  // Metres.
  const auto place = [&](int frame) -> const Vector3d& {
    return std::as_const(clip).translations(frame)[slot];
  };
  return bridge_spikes_of(
      part, kLeastMove / metres_per_unit,
      [&](int a, int b) { return (place(a) - place(b)).norm(); },
      [&](FrameRange gap) { bridge_translations(clip, slot, gap); });
}

}  // namespace

std::vector<std::string> bridge_spikes(Clip& clip, FrameRange part, double metres_per_unit) {
  constexpr double kLongestFrame = 1.0 / 22.0;  // Seconds.
  std::vector<std::string> found;
  if (clip.rate().frame_time() > kLongestFrame) return found;
  for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
    int frames = bridge_turns(clip, part, static_cast<std::size_t>(joint));
    if (const int slot = clip.skeleton().translation_slot(joint); slot >= 0) {
      frames = std::max(frames,
                        bridge_moves(clip, part, static_cast<std::size_t>(slot), metres_per_unit));
    }
    if (frames == 0) continue;
    found.push_back(clip.skeleton().joint(joint).name + " jumped away in " +
                    count_text(frames, "frame"));
  }
  return found;
}

}  // namespace retarget
