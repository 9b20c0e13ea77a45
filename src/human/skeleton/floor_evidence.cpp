#include "human/skeleton/floor_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "human/skeleton/free_fall.h"
#include "retarget/human.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// Lengths in legs.
constexpr double kNearFloor = 0.2, kSteady = 0.1;
constexpr double kStandingHips = 0.6;  // Excludes squatting and kneeling.

// Whether a foot stands flat; nothing if its direction is unknown.
std::optional<bool> stands_flat(const Body& body, const JointPoses& pose, Side side,
                                const Eigen::Vector3d& up) {
  constexpr double kToesUp = 0.17, kToesDown = 0.77;  // Sines of 10 and 50 degrees.
  const auto way = along(body.segment(side_bone(side, LimbBone::kFoot)), pose);
  if (!way) return std::nullopt;
  const double down = -up.dot(way->normalized());
  return down > -kToesUp && down < kToesDown;
}

}  // namespace

bool FloorEvidence::on_floor() const {
  return std::abs(level) <= kNearFloor && wander < kSteady;
}

bool FloorEvidence::resting() const {
  return on_floor() && level >= 0.0;
}

bool FloorEvidence::standing() const {
  constexpr double kMostly = 0.5;
  return hips > kStandingHips && flat.value_or(1.0) >= kMostly;
}

FloorEvidence floor_evidence(const Body& body, const std::vector<JointPoses>& poses,
                             const SignedAxis& up) {
  FloorEvidence found;
  const double leg = leg_length(body);
  if (leg <= 0.0 || poses.empty() || !body.has(Bone::kHips)) return found;
  const Eigen::Vector3d direction = up.direction();
  std::vector<double> levels, hips;
  int flat = 0, seen = 0;
  for (const JointPoses& pose : poses) {
    const auto height = [&](Bone bone) {
      return direction.dot(pose[body.joint(bone)].translation) / leg;
    };
    double lowest = std::numeric_limits<double>::infinity();
    for (const Bone bone : kMappedBones) {
      if (body.has(bone)) lowest = std::min(lowest, height(bone));
    }
    levels.push_back(lowest);
    hips.push_back(height(Bone::kHips) - lowest);
    bool is_flat = false, is_seen = false;
    for (const Side side : kSides) {
      const Bone ankle = side_bone(side, LimbBone::kFoot);
      const auto flat_foot =
          body.has(ankle) ? stands_flat(body, pose, side, direction) : std::nullopt;
      if (!flat_foot) continue;
      is_seen = true;
      is_flat = is_flat || (*flat_foot && height(ankle) - lowest < kNearFloor);
    }
    seen += is_seen ? 1 : 0;
    flat += is_flat ? 1 : 0;
  }
  found.level = median(levels);
  found.wander = found.level - percentile(levels, 10.0);
  found.hips = median(hips);
  if (seen > 0) found.flat = static_cast<double>(flat) / seen;
  return found;
}

bool climbs_along(const FloorEvidence& axis, const FloorEvidence& other) {
  // Stairs and slopes make the lowest joint wander along the true axis, too.
  constexpr double kClimbs = 0.2, kFarther = 1.5;
  return axis.wander > std::max(kClimbs, kFarther * other.wander);
}

bool clearly_stands(const FloorEvidence& standing, const FloorEvidence& other) {
  if (!standing.standing()) return false;
  return standing.on_floor() || climbs_along(other, standing);
}

}  // namespace retarget
