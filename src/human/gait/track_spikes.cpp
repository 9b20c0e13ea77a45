#include "human/gait/track_spikes.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <span>
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
constexpr double kLongestSpikeFrame = 1.0 / 22.0;  // Seconds.

// Whether a track leaves its way in a gap. On its way it moves at the mean velocity across the gap,
// because a swinging limb does not stand before and after a spike.
// @param move  vector from one frame to another one
template <typename Move>
bool leaves_way(FrameRange part, FrameRange gap, double least, const Move& move,
                double step_share = kStepShare) {
  const int before = gap.begin - 1, after = gap.end;
  const Vector3d step = move(before, after) / (after - before);
  const auto distance = [&](int from, int to) -> double {
    return (move(from, to) - (to - from) * step).norm();
  };
  const double jump = std::min(distance(before, gap.begin), distance(gap.end - 1, after));
  if (!(jump > least)) return false;
  double around = 0.0;
  for (int frame = std::max(part.begin, before - kAroundSpike); frame < before; ++frame) {
    around = std::max(around, distance(frame, frame + 1));
  }
  const int last = std::min(part.end - 1, after + kAroundSpike);
  for (int frame = after; frame < last; ++frame) {
    around = std::max(around, distance(frame, frame + 1));
  }
  return around < step_share * jump;
}

// Calls bridge(gap) for each spike. @return number of frames of all spikes.
template <typename Move, typename Bridge>
int bridge_spikes_of(FrameRange part, double least, const Move& move, const Bridge& bridge) {
  // A track whose velocity hardly changes does not leave its way: skips most frames.
  constexpr double kHardly = 0.5;
  static_assert(kHardly < 1.0 - kStepShare);
  int count = 0;
  for (int begin = part.begin + 1; begin + 1 < part.end; ++begin) {
    const bool hardly_changes =
        begin - 1 > part.begin &&
        !((move(begin - 1, begin) - move(begin - 2, begin - 1)).norm() > kHardly * least);
    if (hardly_changes) continue;
    for (int end = begin + 1; end < part.end && end <= begin + kLongestSpike; ++end) {
      if (!leaves_way(part, {begin, end}, least, move)) continue;
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
      [&](int from, int to) { return log_so3(rotation(from).conjugate() * rotation(to)); },
      [&](FrameRange gap) { bridge_rotations(clip, joint, gap); });
}

int bridge_moves(Clip& clip, FrameRange part, std::size_t slot, double metres_per_unit) {
  constexpr double kLeastMove = 0.15;  // Metres.
  const auto place = [&](int frame) -> const Vector3d& {
    return std::as_const(clip).translations(frame)[slot];
  };
  return bridge_spikes_of(
      part, kLeastMove / metres_per_unit,
      [&](int from, int to) -> Vector3d { return place(to) - place(from); },
      [&](FrameRange gap) { bridge_translations(clip, slot, gap); });
}

}  // namespace

std::vector<std::string> bridge_spikes(Clip& clip, FrameRange part, double metres_per_unit) {
  std::vector<std::string> found;
  if (clip.rate().frame_time() > kLongestSpikeFrame) return found;
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

namespace {

using PointTrack = std::vector<Vector3d>;

bool leaves_way(const PointTrack& track, FrameRange gap, double least, double step_share) {
  const auto move = [&](int from, int to) -> Vector3d {
    return track[static_cast<std::size_t>(to)] - track[static_cast<std::size_t>(from)];
  };
  return leaves_way({0, static_cast<int>(track.size())}, gap, least, move, step_share);
}

std::vector<FrameRange> spikes_of(const PointTrack& track, double least) {
  std::vector<FrameRange> found;
  const auto count = static_cast<int>(track.size());
  for (int begin = 1; begin + 1 < count; ++begin) {
    const int last = std::min(begin + kLongestSpike, count - 1);
    for (int end = begin + 1; end <= last; ++end) {
      if (!leaves_way(track, {begin, end}, least, kStepShare)) continue;
      found.push_back({begin, end});
      begin = end;
      break;
    }
  }
  return found;
}

// Puts the frames of a gap on the straight line across it. @return their distances from it
PointTrack straighten(PointTrack& track, FrameRange gap) {
  const Vector3d before = track[static_cast<std::size_t>(gap.begin) - 1];
  const Vector3d after = track[static_cast<std::size_t>(gap.end)];
  PointTrack off;
  for (int frame = gap.begin; frame < gap.end; ++frame) {
    const double share = (frame - gap.begin + 1.0) / (gap.end - gap.begin + 1.0);
    Vector3d& place = track[static_cast<std::size_t>(frame)];
    off.push_back(place - before - share * (after - before));
    place -= off.back();
  }
  return off;
}

// @param gaps  sorted and disjoint
bool overlaps(const std::vector<FrameRange>& gaps, FrameRange gap) {
  const auto next = std::ranges::upper_bound(gaps, gap.begin, {}, &FrameRange::end);
  return next != gaps.end() && next->begin < gap.end;
}

// The root in the world, and the other joints relative to it.
class BodySpikes {
 public:
  BodySpikes(std::vector<PointTrack>& tracks, double least)
      : tracks_(tracks), least_(least), counts_(tracks.size(), 0) {}

  void bridge() {
    for (PointTrack& track : joints()) add_root(track, -1.0);
    bridge_root();
    bridge_joints();
    for (PointTrack& track : joints()) add_root(track, 1.0);
  }

  [[nodiscard]] std::vector<std::string> texts(const std::vector<std::string>& names) const {
    std::vector<std::string> texts, moved;
    if (of_body_ > 0) texts.push_back("the body jumped away in " + count_text(of_body_, "frame"));
    int most = 0, least = std::numeric_limits<int>::max();
    for (std::size_t joint = 0; joint < counts_.size(); ++joint) {
      if (counts_[joint] == 0) continue;
      moved.push_back(names[joint]);
      most = std::max(most, counts_[joint]);
      least = std::min(least, counts_[joint]);
    }
    if (moved.empty()) return texts;
    texts.push_back(list_names(moved, 8) + " jumped away in " + (most > least ? "up to " : "") +
                    count_text(most, "frame"));
    return texts;
  }

 private:
  [[nodiscard]] std::span<PointTrack> joints() { return std::span(tracks_).subspan(1); }

  void add_root(PointTrack& track, double sign) const {
    for (std::size_t i = 0; i < track.size(); ++i) track[i] += sign * tracks_[0][i];
  }

  // If the root alone leaves its way, the other joints leave theirs relative to it.
  void bridge_root() {
    PointTrack& root = tracks_[0];
    for (const FrameRange& gap : spikes_of(root, least_)) {
      const auto others = std::ranges::count_if(joints(), [&](const PointTrack& track) {
        return leaves_way(track, gap, 0.5 * least_, kStepShare);
      });
      const bool alone = 2 * static_cast<std::size_t>(others) > joints().size();
      (alone ? counts_[0] : of_body_) += gap.end - gap.begin;
      const PointTrack off = straighten(root, gap);
      if (!alone) continue;
      for (PointTrack& track : joints()) {
        for (std::size_t i = 0; i < off.size(); ++i) {
          track[static_cast<std::size_t>(gap.begin) + i] += off[i];
        }
      }
    }
  }

  void bridge_joints() {
    std::vector<std::vector<FrameRange>> gaps(tracks_.size());
    for (std::size_t joint = 1; joint < tracks_.size(); ++joint) {
      gaps[joint] = spikes_of(tracks_[joint], least_);
    }
    add_weaker(gaps);
    for (std::size_t joint = 1; joint < tracks_.size(); ++joint) {
      for (const FrameRange& gap : gaps[joint]) {
        straighten(tracks_[joint], gap);
        counts_[joint] += gap.end - gap.begin;
      }
    }
  }

  // Exchanged legs are several spikes, some of which are short. A joint needs less evidence if
  // others jump in the same frames.
  void add_weaker(std::vector<std::vector<FrameRange>>& gaps) const {
    constexpr double kShare = 0.7, kLeast = 0.5;
    constexpr int kFewest = 2;  // Joints.
    std::map<std::pair<int, int>, int> joints_of_gap;
    for (const auto& list : gaps) {
      for (const FrameRange& gap : list) ++joints_of_gap[{gap.begin, gap.end}];
    }
    for (const auto& [ends, count] : joints_of_gap) {
      if (count < kFewest) continue;
      const FrameRange gap{ends.first, ends.second};
      for (std::size_t joint = 1; joint < tracks_.size(); ++joint) {
        std::vector<FrameRange>& own = gaps[joint];
        if (overlaps(own, gap)) continue;
        if (!leaves_way(tracks_[joint], gap, kLeast * least_, kShare)) continue;
        own.insert(std::ranges::upper_bound(own, gap.begin, {}, &FrameRange::begin), gap);
      }
    }
  }

  std::vector<PointTrack>& tracks_;
  double least_;
  std::vector<int> counts_;  // Bridged frames by joint.
  int of_body_ = 0;          // Bridged frames of the whole body.
};

}  // namespace

std::vector<std::string> bridge_spikes(std::vector<std::vector<Vector3d>>& tracks,
                                       const std::vector<std::string>& names, FrameRate rate,
                                       double least) {
  if (tracks.empty() || rate.frame_time() > kLongestSpikeFrame || !(least > 0.0)) return {};
  BodySpikes spikes(tracks, least);
  spikes.bridge();
  return spikes.texts(names);
}

}  // namespace retarget
