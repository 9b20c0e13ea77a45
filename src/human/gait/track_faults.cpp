#include "human/gait/track_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "human/gait/bridge_frames.h"
#include "human/gait/frame_runs.h"
#include "human/skeleton/limb_segments.h"
#include "retarget/human_poser.h"
#include "retarget/so3.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;

bool is_zero(const Quaterniond& rotation) {
  return std::abs(rotation.w()) > 1.0 - 1e-14;
}

double angle_between_rotations(const Quaterniond& a, const Quaterniond& b) {
  return log_so3(a.conjugate() * b).norm();
}

// Marks frames of the zero pose: a calibration pose is not a lost joint.
std::vector<char> zero_poses(const Clip& clip, FrameRange part) {
  std::vector<char> zero(static_cast<std::size_t>(clip.frame_count()), 0);
  for (int frame = part.begin; frame < part.end; ++frame) {
    const auto rotations = clip.rotations(frame);
    const auto zeros = std::ranges::count_if(rotations, is_zero);
    // Half of the joints suffice, because many skeletons have joints that never turn.
    zero[static_cast<std::size_t>(frame)] =
        2 * static_cast<std::size_t>(zeros) > rotations.size() ? 1 : 0;
  }
  return zero;
}

// Movement of a joint in the frames around a gap, without other frames in which it is lost.
struct MovementAround {
  double step = 0.0;  // Largest angle between neighbouring frames.
  double bend = 0.0;  // Largest distance of a frame from the middle of its neighbours.
};

MovementAround movement_around(const Clip& clip, int joint, FrameRange part, FrameRange gap) {
  constexpr int kAround = 3;
  const auto at = static_cast<std::size_t>(joint);
  MovementAround found;
  const int first = std::max(gap.begin - kAround, part.begin);
  const int last = std::min(gap.end + kAround, part.end) - 1;
  for (int frame = first; frame < last; ++frame) {
    const Quaterniond &from = clip.rotations(frame)[at], &to = clip.rotations(frame + 1)[at];
    if (is_zero(from) || is_zero(to)) continue;
    found.step = std::max(found.step, angle_between_rotations(from, to));
    if (frame == first) continue;
    const Quaterniond& before = clip.rotations(frame - 1)[at];
    if (is_zero(before)) continue;
    const Eigen::Vector3d off = log_so3(from.conjugate() * before) + log_so3(from.conjugate() * to);
    found.bend = std::max(found.bend, 0.5 * off.norm());
  }
  return found;
}

// Whether a joint whose rotation is zero in a gap was lost there.
bool is_lost_in(const Clip& clip, int joint, FrameRange part, FrameRange gap) {
  constexpr double kCertain = 20.0 * std::numbers::pi / 180.0, kLeast = 0.1 * kCertain;
  // A joint that stops at zero, such as a straight knee, hardly accelerates before.
  constexpr double kSteps = 2.0, kBends = 3.0;
  const auto at = static_cast<std::size_t>(joint);
  const Quaterniond before = clip.rotations(gap.begin - 1)[at], after = clip.rotations(gap.end)[at];
  const double jump = std::min(log_so3(before).norm(), log_so3(after).norm());
  // The true movement across the gap must be much smaller than the jump.
  if (!(jump > kLeast) || angle_between_rotations(before, after) > 0.5 * jump) return false;
  if (jump > kCertain) return true;
  const MovementAround around = movement_around(clip, joint, part, gap);
  const double frames = 0.5 * (gap.end - gap.begin + 1);
  return jump > kSteps * around.step && jump > kBends * frames * frames * around.bend;
}

// Runs of zero rotations of a joint that are short enough to be bridged, without zero poses.
std::vector<FrameRange> zero_runs(const Clip& clip, int joint, FrameRange part,
                                  const std::vector<char>& zero_poses) {
  constexpr double kLongest = 1.0;  // Seconds.
  const auto at = static_cast<std::size_t>(joint);
  const auto is_lost = [&](int frame) {
    return zero_poses[static_cast<std::size_t>(frame)] == 0 && is_zero(clip.rotations(frame)[at]);
  };
  std::vector<FrameRange> runs;
  for_each_run_where(part.begin, part.end, is_lost, [&](int begin, int end) {
    if (begin == part.begin || end == part.end) return;
    if ((end - begin) * clip.rate().frame_time() > kLongest) return;
    runs.push_back({begin, end});
  });
  return runs;
}

bool contains(const std::vector<FrameRange>& runs, const FrameRange& run) {
  return std::ranges::find(runs, run) != runs.end();
}

// Adds runs of joints whose parent or child is lost in exactly these frames, such as those of a
// nearly straight knee: the limb was lost.
void add_neighbours(const Skeleton& skeleton, const std::vector<std::vector<FrameRange>>& zeros,
                    std::vector<std::vector<FrameRange>>& lost) {
  const auto take = [&](std::size_t from, std::size_t to) {
    bool taken = false;
    for (const FrameRange& run : zeros[to]) {
      if (contains(lost[to], run) || !contains(lost[from], run)) continue;
      lost[to].push_back(run);
      taken = true;
    }
    return taken;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
      const auto at = static_cast<std::size_t>(joint);
      const int parent = skeleton.joint(joint).parent;
      // A lost limb is not a lost body.
      if (parent < 0) continue;
      const auto above = static_cast<std::size_t>(parent);
      changed = take(above, at) || changed;
      if (parent > 0) changed = take(at, above) || changed;
    }
  }
}

}  // namespace

std::vector<std::string> bridge_lost_joints(Clip& clip, FrameRange part) {
  std::vector<std::string> found;
  const std::vector<char> poses = zero_poses(clip, part);
  std::vector<std::vector<FrameRange>> zeros, lost;
  for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
    zeros.push_back(zero_runs(clip, joint, part, poses));
    lost.emplace_back();
    for (const FrameRange& run : zeros.back()) {
      if (is_lost_in(clip, joint, part, run)) lost.back().push_back(run);
    }
  }
  add_neighbours(clip.skeleton(), zeros, lost);
  for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    int frames = 0;
    for (const FrameRange& run : lost[at]) {
      bridge_rotations(clip, at, run);
      frames += run.end - run.begin;
    }
    if (frames == 0) continue;
    found.push_back(clip.skeleton().joint(joint).name + " was lost in " +
                    count_text(frames, "frame"));
  }
  return found;
}

namespace {

// The rotations of a limb's joints in a frame, and how far they get from those of the first frame.
class LimbMovement {
 public:
  LimbMovement(const LimbBones& bones, Bone base, const HumanPose& first)
      : bones_(bones),
        base_(base),
        upper_(between(base, bones.upper, first)),
        lower_(between(bones.upper, bones.lower, first)),
        end_(first[bones.end].translation) {}

  void add(const HumanPose& pose) {
    turned_ =
        std::max({turned_, angle_between_rotations(upper_, between(base_, bones_.upper, pose)),
                  angle_between_rotations(lower_, between(bones_.upper, bones_.lower, pose))});
    travelled_ = std::max(travelled_, (pose[bones_.end].translation - end_).head<2>().norm());
  }

  [[nodiscard]] bool is_still() const { return turned_ < 0.2 * kDegree; }
  [[nodiscard]] bool moves() const { return turned_ > 10.0 * kDegree; }
  [[nodiscard]] bool travels() const { return travelled_ > 0.5; }

 private:
  static constexpr double kDegree = std::numbers::pi / 180.0;

  static Quaterniond between(Bone from, Bone to, const HumanPose& pose) {
    return pose[from].rotation.conjugate() * pose[to].rotation;
  }

  const LimbBones& bones_;
  Bone base_;
  Quaterniond upper_, lower_;
  Eigen::Vector3d end_;
  double turned_ = 0.0, travelled_ = 0.0;  // Rad, metres.
};

// The nearest bone of the source that a limb hangs on.
Bone base_of(const HumanClipInfo& human, const LimbBones& limb) {
  for (const Bone bone : {limb.base, Bone::kSpine2, Bone::kSpine1, Bone::kSpine}) {
    if (human.has(bone)) return bone;
  }
  return Bone::kHips;
}

}  // namespace

StillLimbs find_still_limbs(const Clip& clip, const Calibration& calibration) {
  constexpr double kShortestPose = 0.5;  // Seconds.
  StillLimbs still;
  if (clip.frame_count() == 0) return still;
  HumanPoser poser(clip, calibration);
  const HumanClipInfo human = poser.info();
  HumanPose pose;
  poser.pose(0, pose);
  std::array<std::optional<LimbMovement>, kLimbs.size()> limbs;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const LimbBones& limb = kLimbs[i];
    if (!human.has(limb.upper) || !human.has(limb.lower) || !human.has(limb.end)) continue;
    limbs[i].emplace(limb, base_of(human, limb), pose);
  }
  const auto is_still = [](const auto& limb) { return limb && limb->is_still(); };
  const auto moves = [](const auto& limb) { return limb && limb->moves(); };
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    if (std::ranges::none_of(limbs, is_still)) return still;
    poser.pose(frame, pose);
    for (auto& limb : limbs) {
      if (limb) limb->add(pose);
    }
  }
  const auto may_be_still = [&](const auto& limb) { return !limb || is_still(limb); };
  const bool is_long = clip.frame_count() * clip.rate().frame_time() > kShortestPose;
  still.all = is_long && std::ranges::all_of(limbs, may_be_still);
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const bool leg = i < 2;
    if (!is_still(limbs[i]) || !moves(limbs[i ^ 1])) continue;
    if (leg ? !limbs[i]->travels() : !moves(limbs[0]) && !moves(limbs[1])) continue;
    still.names.emplace_back(kLimbs[i].name);
    still.leg = still.leg || leg;
  }
  return still;
}

}  // namespace retarget
