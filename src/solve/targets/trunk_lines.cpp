#include "solve/targets/trunk_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "retarget/human_skeleton.h"
#include "retarget/statistics.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

constexpr double kMinLineLength = 1e-6;  // Metres; also used for a sine.
constexpr double kDegree = 0.017453292519943295;
// Standing bends of the spine at which standing_trunk_lines() applies none and all of its rotation.
constexpr double kStraightSpine = 3.0 * kDegree;
constexpr double kCurvedSpine = 10.0 * kDegree;

// Rotation from the T-pose to the bone's pose.
Eigen::Quaterniond turn_from_t_pose(const HumanPose& world_from_bone, Bone bone) {
  const Eigen::Quaterniond t_pose(canonical_t_pose(bone));
  return world_from_bone[bone].rotation.normalized() * t_pose.conjugate();
}

// A human's trunk as a chain of bones with constant lengths.
class TrunkChain {
 public:
  explicit TrunkChain(const HumanClipInfo& human) {
    for (const Bone bone : {Bone::kHips, Bone::kSpine, Bone::kSpine1, Bone::kSpine2}) {
      if (human.has(bone)) spine_.push_back(bone);
    }
    for (std::size_t side = 0; side < 2; ++side) {
      const Bone clavicle = side_bone(kSides[side], LimbBone::kShoulder);
      if (human.has(clavicle)) shoulders_[side].push_back(clavicle);
      shoulders_[side].push_back(side_bone(kSides[side], LimbBone::kArm));
    }
  }

  // The lines that the bones of a frame have in the T-pose.
  [[nodiscard]] TrunkLines in_t_pose(const HumanPose& bones) const {
    const Eigen::Vector3d hips =
        0.5 * (bones[Bone::kLeftUpLeg].translation + bones[Bone::kRightUpLeg].translation);
    Eigen::Vector3d spine = Eigen::Vector3d::Zero(), from = hips;
    for (std::size_t i = 1; i < spine_.size(); ++i) {
      const Eigen::Vector3d& to = bones[spine_[i]].translation;
      spine += turn_from_t_pose(bones, spine_[i - 1]).conjugate() * (to - from);
      from = to;
    }
    std::array<Eigen::Vector3d, 2> ends;
    for (std::size_t side = 0; side < 2; ++side) {
      ends[side] = spine;
      Eigen::Vector3d start = from;
      Bone carrier = spine_.back();
      for (const Bone next : shoulders_[side]) {
        const Eigen::Vector3d& to = bones[next].translation;
        ends[side] += turn_from_t_pose(bones, carrier).conjugate() * (to - start);
        start = to;
        carrier = next;
      }
    }
    return {0.5 * (ends[0] + ends[1]), ends[0] - ends[1]};
  }

  // Forward bend of the upper end of the spine relative to the lower end, radians.
  [[nodiscard]] double bend(const HumanPose& bones) const {
    const Eigen::Vector3d up = turn_from_t_pose(bones, spine_.front()).conjugate() *
                               (turn_from_t_pose(bones, spine_.back()) * Eigen::Vector3d::UnitZ());
    return portable::atan2(up.x(), up.z());
  }

  // Whether hips and trunk lean from the vertical by less than 26 degrees.
  [[nodiscard]] bool is_upright(const HumanPose& bones) const {
    constexpr double kUpright = 0.9;
    const Eigen::Vector3d chord = trunk_lines(bones).chord;
    const Eigen::Vector3d hips = turn_from_t_pose(bones, spine_.front()) * Eigen::Vector3d::UnitZ();
    return hips.z() > kUpright && chord.z() > kUpright * chord.norm();
  }

 private:
  std::vector<Bone> spine_;                     // Hips first.
  std::array<std::vector<Bone>, 2> shoulders_;  // Left, right: clavicle, arm.
};

// Rotates a chord that leans back in the T-pose towards the vertical, by `share` of the angle.
void straighten(TrunkLines& lines, double share) {
  const double back = -portable::atan2(lines.chord.x(), lines.chord.z());
  if (!(back > 0.0)) return;
  const auto [sine, cosine] = portable::sin_cos(share * back);
  for (Eigen::Vector3d* line : {&lines.chord, &lines.across}) {
    *line = {cosine * line->x() + sine * line->z(), line->y(),
             cosine * line->z() - sine * line->x()};
  }
}

}  // namespace

TrunkLines trunk_lines(const HumanPose& world_from_bone) {
  const auto at = [&](Bone bone) -> const Eigen::Vector3d& {
    return world_from_bone[bone].translation;
  };
  return {0.5 * (at(Bone::kLeftArm) + at(Bone::kRightArm) - at(Bone::kLeftUpLeg) -
                 at(Bone::kRightUpLeg)),
          at(Bone::kLeftArm) - at(Bone::kRightArm)};
}

std::optional<Eigen::Matrix3d> trunk_frame(const TrunkLines& lines) {
  const double length = lines.chord.norm();
  if (!(length > kMinLineLength)) return std::nullopt;
  const Eigen::Vector3d up = lines.chord / length;
  const Eigen::Vector3d forward = lines.across.cross(up);
  const double clear = forward.norm();
  if (!(clear > kMinLineLength)) return std::nullopt;
  Eigen::Matrix3d frame;
  frame.col(0) = forward / clear;
  frame.col(1) = up.cross(frame.col(0));
  frame.col(2) = up;
  return frame;
}

bool has_trunk(const HumanClipInfo& human) {
  return std::ranges::all_of(
      std::array{Bone::kHips, Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftArm, Bone::kRightArm},
      [&](Bone bone) { return human.has(bone); });
}

double standing_bend(const HumanClipInfo& human, const HumanPoseSource& poses) {
  constexpr double kStep = 0.2, kEnough = 1.0;  // Seconds.
  constexpr double kLowerQuarter = 25.0;
  const int step = std::max(1, static_cast<int>(std::lround(kStep * human.rate.fps())));
  const TrunkChain chain(human);
  HumanPose bones;
  std::vector<double> upright, bends;
  for (int frame = 0; frame < human.frame_count; frame += step) {
    poses(frame, bones);
    bends.push_back(chain.bend(bones));
    // Frames in which the human bends over, sits or lies say little about its stance.
    if (chain.is_upright(bones)) upright.push_back(bends.back());
  }
  const double of_all = percentile(bends, kLowerQuarter);
  if (upright.empty()) return of_all;
  const double seconds = static_cast<double>(upright.size()) * step / human.rate.fps();
  return std::lerp(of_all, percentile(upright, kLowerQuarter), std::min(1.0, seconds / kEnough));
}

TrunkLines standing_trunk_lines(const HumanClipInfo& human, const HumanPoseSource& poses) {
  if (human.built) return {human.built->trunk, human.built->shoulders};
  constexpr int kMaxFrames = 100;
  const int step = std::max(1, (human.frame_count + kMaxFrames - 1) / kMaxFrames);
  const TrunkChain chain(human);
  HumanPose bones;
  TrunkLines sum;
  int frames = 0;
  for (int frame = 0; frame < human.frame_count; frame += step) {
    poses(frame, bones);
    const TrunkLines lines = chain.in_t_pose(bones);
    sum.chord += lines.chord;
    sum.across += lines.across;
    ++frames;
  }
  if (frames == 0) return sum;
  sum.chord /= frames;
  sum.across /= frames;
  const double bend = human.standing_bend ? *human.standing_bend : standing_bend(human, poses);
  const double curved = (bend - kStraightSpine) / (kCurvedSpine - kStraightSpine);
  straighten(sum, std::clamp(curved, 0.0, 1.0));
  return sum;
}

}  // namespace retarget
