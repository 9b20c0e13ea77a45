#pragma once

#include <Eigen/Core>
#include <vector>

#include "human/gait/source_feet.h"

namespace retarget {

/// Evidence of root errors from standing feet. A foot stands if it does not turn, and is the lower
/// foot or moves like the other one; this does not depend on the root. No foot stands while the
/// body is in free fall, or if the body carries it. Lengths and speeds refer to a body with legs of
/// kUsualSourceLeg.
struct RootEvidence {
  double seconds = 0.0;  ///< Time in which both feet stand.
  double speed = 0.0;    ///< Speed that they exceed in 65 % of this time, m/s; 0 for an exact root.
  double single_seconds = 0.0;  ///< Like `seconds` and `speed`, for a single foot.
  double single_speed = 0.0;
  /// Climb of the standing feet over the clip, metres, and whether they climb steadily and the
  /// lowest foot climbs as well. On stairs, feet do not climb while they stand.
  double climb = 0.0;
  bool climbs_steadily = false;
  double climb_seconds = 0.0;  ///< Time in which any foot stands.
  /// Vertical speed that all these feet exceed in 65 % of this time, m/s.
  double climb_speed = 0.0;
  /// Like climb_speed, for the deviation of the vertical speed from its median: a foot that rolls
  /// sinks, but always in the same way. Motion capture stays below 0.02.
  double shake_speed = 0.0;

  /// Whether the root certainly moves relative to standing feet.
  [[nodiscard]] bool moves() const;
  /// Whether it also moves vertically.
  [[nodiscard]] bool climbs() const;
};

/// @param hips  hip positions by frame, which tell carried feet (planted_parts.h); world, metres
[[nodiscard]] RootEvidence measure_root(const SourceFeet& feet,
                                        const std::vector<Eigen::Vector3d>& hips);

/// Whether the root translation is missing or centred, rather than noisy: the hips hardly move, and
/// even the slowest end of a foot moves faster.
[[nodiscard]] bool root_is_missing(const SourceFeet& feet,
                                   const std::vector<Eigen::Vector3d>& hips);

/// Error of the root, by frame.
struct RootDrift {
  std::vector<Eigen::Vector3d> drift;  ///< World, metres.
  /// Vertical part that was discarded because it moves stances away from one level, metres; empty:
  /// none.
  std::vector<double> discarded_heights;
  /// Median speed of foot ends that probably stand, apart from that of rolling feet, m/s;
  /// horizontal if heights were discarded.
  double speed_before = 0.0;
  /// Value of speed_before after the drift is removed, also its slow part (DriftRule::wander).
  double speed_after = 0.0;
  double speed_left = 0.0;    ///< Value of speed_before after `drift` is removed.
  double climb_before = 0.0;  ///< Climb of these foot ends over the clip, metres.
  double climb_after = 0.0;   ///< Value of climb_before after the drift is removed.
  double farthest = 0.0;      ///< Largest distance of the drift from its median, metres.

  /// Whether feet that probably stand are much slower after the drift is removed.
  [[nodiscard]] bool calms_feet() const;
  /// Whether feet that probably stand are much slower, or no longer climb: a slow climb is hidden
  /// in the usual speed of standing feet.
  [[nodiscard]] bool helps() const;
};

struct DriftRule {
  bool jittery = false;  ///< The limbs had noise, some of which remains.
  bool vertical = true;  ///< The root height drifts as well; otherwise it stays unchanged.
  /// If so: the standing feet climb with the root through the clip. Otherwise a common vertical
  /// speed of all stances is that of feet that roll, and the root does not have it.
  bool climbs = true;
  /// FootNoise::wander of the legs, if nothing else shows that the root drifts; 0: the root drifts.
  /// The horizontal part of a drift that this noise explains only has fast changes (keep_travel).
  double wander = 0.0;
};

/// Finds the drift that makes foot ends that probably stand do so, and keeps them on one level if
/// they share one: the differences of the drift equal those of the feet. Between stances the drift
/// is as smooth as within them, and the hips move smoothly without it. Iterative reweighting
/// removes ends that only seemed to stand. A vertical drift is discarded if it moves stances away
/// from one level.
/// A vertical drift flattens steps and boxes if the stances differ by less than 0.15 m in height:
/// noise and a step cannot be distinguished. Feet that the body carries do not stand
/// (planted_parts.h).
/// @param hips  hip positions by frame; world, metres
[[nodiscard]] RootDrift find_root_drift(const SourceFeet& feet,
                                        const std::vector<Eigen::Vector3d>& hips,
                                        DriftRule rule = {});

}  // namespace retarget
