#include "human/gait/seats.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/segment.h"
#include "human/gait/frame_runs.h"
#include "human/gait/standing_heights.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Lengths in metres and speeds in m/s for a body with legs of kUsualSourceLeg.
constexpr double kStillHips = 0.12;     // Speed.
constexpr double kShortestSeat = 0.5;   // Seconds.
constexpr double kLevelThigh = 0.6;     // Greatest sine of the slope of a sitting body's thigh.
constexpr double kBehindFeet = 0.2;     // Of the hips and the trunk of a sitting body.
constexpr double kSeatDepth = 0.13;     // From the joint of the hips to the skin.
constexpr double kLowestSeat = 0.2;     // Lower hips rest on the floor.
constexpr double kUprightTrunk = 0.75;  // Least sine of its slope.

constexpr std::array kArms = {Bone::kLeftForeArm, Bone::kRightForeArm, Bone::kLeftHand,
                              Bone::kRightHand};
constexpr std::array kFeet = {Bone::kLeftFoot, Bone::kRightFoot, Bone::kLeftToe, Bone::kRightToe};

// Whether limbs carry the trunk, as in a plank or a bridge: it is flat and lies away from the feet;
// an elbow, a hand or its upper end and a foot are lower than a seat would be.
bool limbs_carry(const HumanClipInfo& human, const HumanPose& pose, Bone top, double scale) {
  const auto place = [&](Bone bone) -> const Vector3d& { return pose[bone].translation; };
  const Vector3d& hips = place(Bone::kHips);
  const Vector3d trunk = place(top) - hips;
  // Also false for a body whose trunk is unknown.
  if (trunk.z() >= kUprightTrunk * trunk.norm()) return false;
  const Vector3d feet = 0.5 * (place(Bone::kLeftFoot) + place(Bone::kRightFoot)) - hips;
  if (trunk.head<2>().dot(feet.head<2>()) > 0.0) return false;
  const auto is_low = [&](Bone bone) {
    return human.has(bone) && place(bone).z() < hips.z() - kSeatDepth * scale;
  };
  return std::ranges::any_of(kFeet, is_low) && (is_low(top) || std::ranges::any_of(kArms, is_low));
}

// Whether the body sits in a pose: its thighs are level, and hips and trunk are behind the feet.
// In a squat or a wide stance, the trunk is above the line between the feet.
// @param top  the upper end of the trunk
bool is_sitting(const HumanPose& pose, Bone top, double scale, double floor) {
  const auto place = [&](Bone bone) -> const Vector3d& { return pose[bone].translation; };
  const Vector3d& hips = place(Bone::kHips);
  const double height = hips.z() - floor;
  if (height < kLowestSeat * scale || height > 0.8 * kUsualSourceLeg * scale) return false;
  for (const Side side : kSides) {
    const Vector3d thigh =
        place(side_bone(side, LimbBone::kLeg)) - place(side_bone(side, LimbBone::kUpLeg));
    if (!(std::abs(thigh.z()) <= kLevelThigh * thigh.norm())) return false;
  }
  const Vector2d left = place(Bone::kLeftFoot).head<2>(), right = place(Bone::kRightFoot).head<2>();
  const auto is_behind = [&](const Vector2d& point) {
    return (point - nearest_on_segment(point, left, right)).norm() >= kBehindFeet * scale;
  };
  const Vector3d middle = 0.5 * (hips + place(top));
  return is_behind(hips.head<2>()) && is_behind(middle.head<2>());
}

}  // namespace

std::vector<SeatRest> find_seats(const HumanClipInfo& human, const HumanPoseSource& poses,
                                 const ContactPlan& contacts) {
  std::vector<SeatRest> seats;
  for (const LimbBone part : {LimbBone::kUpLeg, LimbBone::kLeg, LimbBone::kFoot}) {
    for (const Side side : kSides) {
      if (!human.has(side_bone(side, part))) return seats;
    }
  }
  if (!human.has(Bone::kHips)) return seats;
  Bone top = Bone::kHips;
  if (human.has(Bone::kNeck)) {
    top = Bone::kNeck;
  } else if (human.has(Bone::kHead)) {
    top = Bone::kHead;
  }
  const double scale = contacts.scale, floor = floor_height(contacts);
  const double frame_time = human.rate.frame_time();
  std::vector<Vector3d> hips;
  std::vector<char> sitting;
  HumanPose pose;
  for (int frame = 0; frame < human.frame_count; ++frame) {
    poses(frame, pose);
    hips.push_back(pose[Bone::kHips].translation);
    const bool sits = is_sitting(pose, top, scale, floor) && !limbs_carry(human, pose, top, scale);
    sitting.push_back(sits ? 1 : 0);
  }
  const auto at = [&](int frame) -> const Vector3d& {
    return hips[static_cast<std::size_t>(frame)];
  };
  const auto rests = [&](int frame) {
    const int from = std::max(0, frame - 1), to = std::min(human.frame_count - 1, frame + 1);
    const double speed = (at(to) - at(from)).norm() / (frame_time * std::max(1, to - from));
    return speed < kStillHips * scale && sitting[static_cast<std::size_t>(frame)] != 0;
  };
  for_each_run_where(0, human.frame_count, rests, [&](int begin, int end) {
    if ((end - begin) * frame_time < kShortestSeat) return;
    std::vector<double> heights;
    Vector2d middle = Vector2d::Zero();
    for (int frame = begin; frame < end; ++frame) {
      heights.push_back(at(frame).z() - kSeatDepth * scale);
      middle += at(frame).head<2>() / (end - begin);
    }
    seats.push_back({{begin, end}, median_in_place(heights), middle});
  });
  return seats;
}

}  // namespace retarget
