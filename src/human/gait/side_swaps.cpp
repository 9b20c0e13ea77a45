#include "human/gait/side_swaps.h"

#include <fmt/format.h>
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>

#include "human/skeleton/joint_names.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using SwapTracks = std::vector<std::vector<Vector3d>>;

// Joints of both sides: left and right.
using JointPair = std::pair<std::size_t, std::size_t>;
using JointPairs = std::vector<JointPair>;

constexpr double kMuchNearer = 0.5;

bool is_of_arm(const JointName& name) {
  return may_mean(name, side_bone(name.side, LimbBone::kArm)) ||
         may_mean(name, side_bone(name.side, LimbBone::kForeArm)) ||
         may_mean(name, side_bone(name.side, LimbBone::kHand));
}

bool is_of_leg(const JointName& name) {
  return may_mean(name, side_bone(name.side, LimbBone::kUpLeg)) ||
         may_mean(name, side_bone(name.side, LimbBone::kLeg)) ||
         may_mean(name, side_bone(name.side, LimbBone::kFoot)) ||
         may_mean(name, side_bone(name.side, LimbBone::kToe));
}

template <typename IsOfLimb>
JointPairs pairs_of(const std::vector<JointName>& names, const IsOfLimb& is_of_limb) {
  JointPairs pairs;
  for (std::size_t left = 0; left < names.size(); ++left) {
    if (names[left].side != Side::kLeft || !is_of_limb(names[left])) continue;
    const auto right = std::ranges::find(names, JointName{Side::kRight, names[left].base});
    if (right != names.end()) {
      pairs.emplace_back(left, static_cast<std::size_t>(right - names.begin()));
    }
  }
  return pairs;
}

// The frames from which both limbs continue the tracks of the other side.
std::vector<std::size_t> frames_of_swaps(const SwapTracks& tracks, const JointPairs& pairs,
                                         double least) {
  std::vector<std::size_t> found;
  for (std::size_t frame = 1; frame < tracks.front().size(); ++frame) {
    double same = 0.0, other = 0.0;
    for (const auto& [left, right] : pairs) {
      const Vector3d &was_left = tracks[left][frame - 1], &was_right = tracks[right][frame - 1];
      const Vector3d &left_now = tracks[left][frame], &right_now = tracks[right][frame];
      same += (left_now - was_left).norm() + (right_now - was_right).norm();
      other += (left_now - was_right).norm() + (right_now - was_left).norm();
    }
    const double joints = 2.0 * static_cast<double>(pairs.size());
    if (same > least * joints && other < kMuchNearer * same) found.push_back(frame);
  }
  return found;
}

// Whether the line between the joints turns around in a frame. The body may move farther than the
// distance of collarbones.
bool turns_around(const SwapTracks& tracks, const JointPair& pair, std::size_t frame) {
  const auto& [left, right] = pair;
  const Vector3d before = tracks[right][frame - 1] - tracks[left][frame - 1];
  const Vector3d now = tracks[right][frame] - tracks[left][frame];
  return (now + before).norm() < kMuchNearer * (now - before).norm();
}

// Collarbones and fingers need not exchange sides with the limb.
JointPairs that_swap_too(const SwapTracks& tracks, const JointPairs& pairs, std::size_t begin,
                         std::size_t end) {
  JointPairs found;
  std::ranges::copy_if(pairs, std::back_inserter(found), [&](const JointPair& pair) {
    return turns_around(tracks, pair, begin) && turns_around(tracks, pair, end);
  });
  return found;
}

void swap_sides(SwapTracks& tracks, const JointPairs& pairs, std::size_t begin, std::size_t end) {
  for (const auto& [left, right] : pairs) {
    for (std::size_t frame = begin; frame < end; ++frame) {
      std::swap(tracks[left][frame], tracks[right][frame]);
    }
  }
}

// Undoes the exchanges of two limbs, or reports them. @param others  pairs of no limb
void undo_swaps_of(SwapTracks& tracks, const JointPairs& pairs, const JointPairs& others,
                   double least, std::string_view limbs, SideSwaps& found) {
  constexpr std::size_t kFewestPairs = 2, kShare = 3;
  if (pairs.size() < kFewestPairs) return;
  const std::vector<std::size_t> swaps = frames_of_swaps(tracks, pairs, least);
  if (swaps.empty()) return;
  std::size_t frames = 0;
  for (std::size_t i = 0; i + 1 < swaps.size(); i += 2) frames += swaps[i + 1] - swaps[i];
  if (swaps.size() % 2 == 1 || kShare * frames >= tracks.front().size()) {
    std::vector<std::string> places;
    for (const std::size_t swap : swaps) places.push_back(std::to_string(swap));
    const bool is_one = swaps.size() == 1;
    found.kept.push_back(fmt::format("the {} exchange sides in {} {}: {}, left and right are wrong",
                                     limbs, is_one ? "frame" : "frames", list_names(places, 8),
                                     is_one ? "on one side of it" : "between some of them"));
    return;
  }
  for (std::size_t i = 0; i + 1 < swaps.size(); i += 2) {
    const JointPairs too = that_swap_too(tracks, others, swaps[i], swaps[i + 1]);
    swap_sides(tracks, pairs, swaps[i], swaps[i + 1]);
    swap_sides(tracks, too, swaps[i], swaps[i + 1]);
  }
  found.undone.push_back(fmt::format("the {} exchanged sides in {}", limbs,
                                     count_text(static_cast<long>(frames), "frame")));
}

}  // namespace

SideSwaps undo_side_swaps(SwapTracks& tracks, const std::vector<std::string>& names, double least) {
  SideSwaps found;
  if (tracks.empty() || tracks.size() != names.size() || !(least > 0.0)) return found;
  const std::vector<JointName> words = normalise_joint_names(names);
  const auto is_of_none = [](const JointName& name) {
    return !is_of_leg(name) && !is_of_arm(name);
  };
  const JointPairs others = pairs_of(words, is_of_none);
  undo_swaps_of(tracks, pairs_of(words, is_of_leg), others, least, "legs", found);
  undo_swaps_of(tracks, pairs_of(words, is_of_arm), others, least, "arms", found);
  return found;
}

}  // namespace retarget
