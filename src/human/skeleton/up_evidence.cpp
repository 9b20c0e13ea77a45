#include "human/skeleton/up_evidence.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/math/free_fall.h"
#include "human/skeleton/body_masses.h"
#include "human/skeleton/floor_slope.h"
#include "retarget/human.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// The body's centre of mass, about 60 times a second.
struct CentreTrack {
  std::vector<Vector3d> places;  // Legs.
  double step = 0.0;             // Seconds.
};

CentreTrack centre_track(const Clip& clip, const Body& body, int begin, double leg) {
  constexpr double kRate = 60.0;
  const int stride = std::max(1, static_cast<int>(std::lround(clip.rate().fps() / kRate)));
  CentreTrack track;
  track.step = clip.rate().frame_time() * stride;
  for (int frame = begin; frame < clip.frame_count(); frame += stride) {
    const JointPoses pose = frame_pose(clip, frame);
    const auto [sum, mass] = weighted_positions(
        [&](Bone bone) { return body.has(bone); },
        [&](Bone bone) -> const Vector3d& { return pose[body.joint(bone)].translation; });
    track.places.emplace_back(sum / (mass * leg));
  }
  return track;
}

// The accelerations of the sections in which the centre of mass follows a parabola like that of a
// fall.
std::vector<Vector3d> falls_of(const CentreTrack& track) {
  constexpr double kLeast = 9.0, kMost = 16.0;  // Legs/s^2.
  constexpr double kMaxResidual = 0.03;         // Share of the parabola's height.
  std::vector<Vector3d> falls;
  const auto half = static_cast<std::size_t>(free_fall_reach(track.step));
  if (half == 0) return falls;
  const double reach = static_cast<double>(half) * track.step;
  const std::size_t length = 2 * half + 1;
  for (std::size_t first = 0; first + length <= track.places.size(); ++first) {
    const Parabola parabola =
        fit_parabola(std::span(track.places).subspan(first, length), track.step);
    const double strength = parabola.acceleration.norm();
    if (strength > kLeast && strength < kMost &&
        parabola.residual <= kMaxResidual * 0.5 * strength * reach * reach) {
      falls.push_back(parabola.acceleration);
    }
  }
  return falls;
}

}  // namespace

double leg_length(const Body& body) {
  double sum = 0.0;
  int sides = 0;
  for (const Side side : kSides) {
    const double thigh = length_by_offsets(body, side_bone(side, LimbBone::kUpLeg));
    const double shin = length_by_offsets(body, side_bone(side, LimbBone::kLeg));
    if (thigh <= 0.0 || shin <= 0.0) continue;
    sum += thigh + shin;
    ++sides;
  }
  return sides > 0 ? sum / sides : 0.0;
}

std::optional<SignedAxis> free_fall_axis(const Clip& clip, const Body& body, int begin) {
  constexpr double kMinFlight = 0.25, kMinCoherence = 0.75, kMinCosine = 0.9;
  constexpr double kSame = 0.25;  // Deviation from the median acceleration, as a share of it.
  const double leg = leg_length(body);
  if (leg <= 0.0 || !body.has(Bone::kHips)) return std::nullopt;
  const CentreTrack track = centre_track(clip, body, begin, leg);
  const std::vector<Vector3d> falls = falls_of(track);
  Vector3d sum = Vector3d::Zero(), gravity = Vector3d::Zero();
  for (const Vector3d& fall : falls) sum -= fall.normalized();
  const auto count = static_cast<double>(falls.size());
  if (falls.empty() || sum.norm() < kMinCoherence * count) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> parts;
    for (const Vector3d& fall : falls) parts.push_back(fall[axis]);
    gravity[axis] = median(parts);
  }
  const auto same = std::ranges::count_if(falls, [&](const Vector3d& fall) {
    return (fall - gravity).norm() < kSame * gravity.norm();
  });
  if (static_cast<double>(same) * track.step < kMinFlight) return std::nullopt;
  const SignedAxis up = nearest_axis(sum);
  if (up.direction().dot(sum.normalized()) < kMinCosine) return std::nullopt;
  return up;
}

namespace {

// Lengths in legs.
constexpr double kNearFloor = 0.2, kSteady = 0.1;
constexpr double kStandingHips = 0.6;  // Excludes squatting and kneeling.
constexpr double kMotionless = 1e-6;   // Recorded hips always move.

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

// The hips of a lying body are above its floor.
bool is_centred(const std::vector<Vector3d>& hips) {
  constexpr double kAtOrigin = 0.03, kNoise = 0.075;
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& place : hips) middle += place / static_cast<double>(hips.size());
  std::vector<double> distances;
  for (const Vector3d& place : hips) distances.push_back((place - middle).norm());
  return middle.norm() <= kAtOrigin && percentile(distances, 80.0) <= kNoise;
}

bool FloorEvidence::is_steady() const {
  return wander < kSteady;
}

bool FloorEvidence::on_floor() const {
  return std::abs(level) <= kNearFloor && is_steady();
}

bool FloorEvidence::resting() const {
  // Recorded joints sink into the floor by centimetres.
  constexpr double kSinks = 0.1;
  return on_floor() && level >= -kSinks && is_placed;
}

bool FloorEvidence::on_slope() const {
  constexpr double kMuchLess = 0.3;
  return sloped_wander < kSteady && sloped_wander < kMuchLess * wander;
}

bool FloorEvidence::may_rest() const {
  constexpr double kSteadyEnough = 0.2;
  return std::abs(level) <= kNearFloor && wander < kSteadyEnough && is_placed;
}

bool FloorEvidence::is_far() const {
  constexpr double kFar = 0.5;
  return std::abs(level) > kFar;
}

bool FloorEvidence::squatting() const {
  constexpr double kMoves = 0.2, kMuchLess = 0.3, kMostly = 0.5;
  return on_floor() && flat.value_or(0.0) >= kMostly && sway > kMoves && span < kMuchLess * sway;
}

bool FloorEvidence::is_steadier_than(const FloorEvidence& other) const {
  constexpr double kStill = 0.02, kMuchLess = 0.4;
  const double others = std::min(other.span, other.sway);
  return others > kStill && (on_slope() ? sloped_span : span) < kMuchLess * others;
}

bool FloorEvidence::sinks_rather_than(const FloorEvidence& other) const {
  constexpr double kSinks = 0.2, kMuchLess = 0.5;
  return depth > kSinks && other.depth < kMuchLess * depth;
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
  std::vector<double> levels, hips, places;
  Eigen::AlignedBox3d roots;
  std::vector<Vector3d> root_track;
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
    root_track.emplace_back(pose[body.joint(Bone::kHips)].translation / leg);
    roots.extend(root_track.back());
    places.push_back(height(Bone::kHips));
    hips.push_back(places.back() - lowest);
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
  const std::vector<double> sloped = without_slope(levels, root_track, up.axis);
  found.sloped_wander = median(sloped) - percentile(sloped, 10.0);
  found.sloped_span = percentile(sloped, 90.0) - percentile(sloped, 10.0);
  found.wander = found.level - percentile(levels, 10.0);
  found.depth = found.level - percentile(levels, 3.0);
  found.span = percentile(levels, 90.0) - percentile(levels, 10.0);
  found.sway = percentile(places, 90.0) - percentile(places, 10.0);
  found.hips = median(hips);
  const bool rests = roots.sizes().maxCoeff() <= kMotionless;
  found.is_placed = rests ? std::abs(direction.dot(roots.center())) > kMotionless
                          : roots.sizes()[up.axis] > kMotionless && !is_centred(root_track);
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
  return standing.on_floor() || standing.on_slope() || climbs_along(other, standing);
}

}  // namespace retarget
