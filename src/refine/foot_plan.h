#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "refine/frame_terms.h"
#include "retarget/math/pose.h"
#include "retarget/refine/fit_options.h"

namespace retarget {

/// The feet of the source in one frame.
struct SourceFoot {
  Eigen::Vector3d ankle = Eigen::Vector3d::Zero();  ///< World, metres.
  Eigen::Vector3d toe = Eigen::Vector3d::Zero();
  double up = 1.0;    ///< Height of the unit vector that points up from a standing foot.
  double side = 0.0;  ///< The same of the one to its side.
};

/// A time in which one end of a foot stays where it is.
struct PlantedPhase {
  int begin = 0, end = 0;  ///< Frames [begin, end).
  int foot = 0;            ///< Index of the robot's foot.
  int foot_end = kHeel;
};

/// Feet and legs of the source over a clip, by the robot's feet.
struct SourceFeet {
  double frame_time = 1.0 / 30.0;
  double leg_length = 0.85;      ///< Thigh and shank, metres.
  std::vector<SourceFoot> feet;  ///< Frame-major, foot_count a frame.
  int foot_count = 0;

  [[nodiscard]] int frame_count() const {
    return foot_count == 0 ? 0 : static_cast<int>(feet.size()) / foot_count;
  }
  [[nodiscard]] const SourceFoot& at(int frame, int foot) const {
    return feet[static_cast<std::size_t>(frame) * static_cast<std::size_t>(foot_count) +
                static_cast<std::size_t>(foot)];
  }
};

/// Heights at which the source's feet stand.
struct StandingHeights {
  double ankle = 0.0, toe = 0.0;  ///< World, metres.
  bool found = false;             ///< False: no foot stands long enough; a guess.
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
