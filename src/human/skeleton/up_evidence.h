#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/clip.h"
#include "retarget/options.h"

namespace retarget {

/// Finds the up axis from free fall: in flight, the centre of mass has a constant acceleration
/// along gravity. Returns nothing if the clip has less than a quarter of a second of flight with
/// the same acceleration. Smoothed landings also resemble parabolas, but of differing accelerations.
///
/// Lengths are in legs, so the unit is not needed: gravity is 9 to 16 legs/s^2 for legs of 1.1 to
/// 0.6 m.
/// @param begin  first frame to use
[[nodiscard]] std::optional<SignedAxis> free_fall_axis(const Clip& clip, const Body& body,
                                                       int begin);

/// Length of thigh and shin from the OFFSETs, averaged over both sides, file units; 0 if unknown.
[[nodiscard]] double leg_length(const Body& body);

/// Evidence that an axis points up, from how the floor would support the body. Lengths are in legs
/// (thigh plus shin).
struct FloorEvidence {
  double wander =
      0.0;  ///< Range of the lowest joint's height between its tenth and fiftieth percentiles.
  double depth =
      0.0;            ///< How far the lowest joint goes below its median height (third percentile).
  double span = 0.0;  ///< Range of the lowest joint's height, tenth to ninetieth percentile.
  double sway = 0.0;  ///< Range of the hips' positions along the axis, same percentiles.
  double sloped_wander = 0.0;  ///< `wander` above the slope that fits best (without_slope()).
  double sloped_span = 0.0;    ///< `span` above this slope.
  double level = 0.0;          ///< Median height of the lowest joint.
  double hips = 0.0;           ///< Median height of the hips above the lowest joint.
  /// Share of the poses in which a foot stands flat near the lowest joint. Empty: the foot
  /// directions are unknown.
  std::optional<double> flat;
  /// Whether the hips have positions along the axis: they move along it, or rest away from 0 in a
  /// clip in which they do not move at all. False in centred motions, also with noise.
  bool is_placed = false;

  /// Whether the lowest joint stays at one height, as on a floor.
  [[nodiscard]] bool is_steady() const;
  /// Whether the lowest joint stays at height 0, as in nearly all recordings along the true axis.
  [[nodiscard]] bool on_floor() const;
  /// Whether the lowest joint stays on a slope, as in tilted world coordinates.
  [[nodiscard]] bool on_slope() const;
  /// Whether the body rests on a floor at height 0: no joint is far below it, and the hips have
  /// positions.
  [[nodiscard]] bool resting() const;
  /// Weaker than resting(): the lowest joint is near height 0, and the hips have positions.
  [[nodiscard]] bool may_rest() const;
  /// Whether the lowest joint is far from height 0.
  [[nodiscard]] bool is_far() const;
  /// Whether the hips are at standing height above flat feet.
  [[nodiscard]] bool standing() const;
  /// Whether the hips move up and down above flat feet that rest at height 0, as in squats. Hips
  /// of a lying body do not slide while its feet rest.
  [[nodiscard]] bool squatting() const;
  /// Whether the lowest joint's height varies much less than it does along another axis, where the
  /// hips sway, too. The hips of a lying body do not leave its floor.
  [[nodiscard]] bool is_steadier_than(const FloorEvidence& other) const;
  /// Whether the body sinks into this floor, and much less into that of another axis. No body goes
  /// below the floor that carries it.
  [[nodiscard]] bool sinks_rather_than(const FloorEvidence& other) const;
};

/// Returns zeros if the legs have no length.
[[nodiscard]] FloorEvidence floor_evidence(const Body& body, const std::vector<JointPoses>& poses,
                                           const SignedAxis& up);

/// Whether the hips stay at the origin, apart from noise: such a motion is centred and lies on no
/// floor.
/// @param hips  positions in legs, by pose
[[nodiscard]] bool is_centred(const std::vector<Eigen::Vector3d>& hips);

/// Whether the lowest joint climbs or travels along an axis, and much less along another one.
[[nodiscard]] bool climbs_along(const FloorEvidence& axis, const FloorEvidence& other);

/// Whether the body clearly stands along the first axis, and does not lie, crawl or hang along the
/// other one: it stands on a floor at height 0 or on a slope, or its lowest joint would climb along the
/// other axis.
[[nodiscard]] bool clearly_stands(const FloorEvidence& standing, const FloorEvidence& other);

}  // namespace retarget
