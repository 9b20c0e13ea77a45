#pragma once

#include <array>
#include <vector>

#include "refine/source_feet.h"
#include "retarget/options.h"

namespace retarget {

/// A time in which a foot of the source stands on something above the floor: a box, a stair.
struct RaisedStance {
  int begin = 0, end = 0;          ///< Frames [begin, end) in which the whole foot is still.
  std::array<double, 2> height{};  ///< Of what is under heel and toe, metres above the floor.
};

/// Nothing but the foot itself tells of what it stands on, so it must be as still as feet are that
/// carry a body: upright, both ends slow for FitOptions::support_time and at one place within
/// FitOptions::support_drift. Feet that are held in the air hardly ever are; those that are lose
/// nothing when they stay where they are.
///
/// Heel and toe have one height where they differ by little: the sole lies flat.
[[nodiscard]] std::vector<RaisedStance> find_raised_stances(const SourceFeet& source,
                                                            const StandingHeights& standing,
                                                            int foot, const FitOptions& options);

}  // namespace retarget
