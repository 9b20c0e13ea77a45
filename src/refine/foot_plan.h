#pragma once

#include <span>
#include <vector>

#include "refine/frame_terms.h"
#include "refine/source_feet.h"
#include "retarget/options.h"

namespace retarget {

/// A time in which one end of a foot stays where it is.
struct PlantedPhase {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  int foot = 0;            ///< Index of the robot's foot.
  int foot_end = kHeel;
};

/// What the robot's feet should do, clip-wide.
struct FootPlan {
  int foot_count = 0;
  std::vector<FootEndGoal> ends;  ///< Frame-major, two a foot.
  std::vector<double> upright;    ///< Frame-major, one a foot.
  std::vector<PlantedPhase> phases;

  [[nodiscard]] std::span<const FootEndGoal> ends_of(int frame) const;
  [[nodiscard]] std::span<const double> upright_of(int frame) const;
};

/// Learned from slow feet near the lowest height that have the pitch of a standing foot: clips in
/// which people lie have lower toes than those they stand on.
[[nodiscard]] StandingHeights find_standing_heights(const SourceFeet& source,
                                                    const FitOptions& options);

/// Contact phases of heels and toes, and their clearances.
/// @param scale  of the robot's foot paths against the source's.
[[nodiscard]] FootPlan plan_feet(const SourceFeet& source, const StandingHeights& standing,
                                 double scale, const FitOptions& options);

}  // namespace retarget
