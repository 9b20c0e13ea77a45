#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edit/find_seam.h"
#include "edit/plant_feet.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// How one clip becomes the next.
enum class SeamBlend : std::uint8_t {
  kCrossfade,  ///< Both are mixed over the frames that they share.
  kInertial,   ///< At once; what the second lacks to the first fades in it.
};

/// What joints may do at a seam or on a path, times their 99.9th percentile in the clips.
struct MotionLimits {
  double speed = 3.0;
  double acceleration = 3.0;
};

struct ConcatenateOptions {
  SeamOptions seam;
  /// Where no good seam is within seam.band, twice as much is searched, and again, up to so many
  /// seconds: recordings often begin with seconds of a T-pose that nothing goes on to.
  double widest_band = 32.0;
  SeamBlend blend = SeamBlend::kCrossfade;
  double fade = 0.35;      ///< Of kInertial: how long the difference fades, seconds.
  double threshold = 0.2;  ///< Largest distance of a seam, metres.
  MotionLimits limits;     ///< Of the joints at the seam.
  /// Of planted feet at the seam: mean speed over the floor, m/s, beyond what they slip in the
  /// clips.
  double slip = 0.1;
  double jump = 0.5;  ///< Of a planted foot at the seam, beyond what it does in the clips, m/s.
  /// Clips whose floors are farther apart are tried on one floor too, metres.
  double same_floor = 0.02;
  PlantOptions plant;
};

/// What a seam became.
struct SeamCheck {
  double usual_speed = 0.0;    ///< 99.9th percentile of the clips' joint speeds, m/s: the joint's
                               ///< own, or that of all joints where this is less.
  double largest_speed = 0.0;  ///< Of the joint at the seam that is fastest for what it does, m/s,
  std::string fastest_bone;    ///< and which it is.
  double usual_acceleration = 0.0;    ///< The same of accelerations, m/s2; where a clip itself has
  double largest_acceleration = 0.0;  ///< as large a one at that time it does not count.
  std::string jolted_bone;
  double slip = 0.0;      ///< Mean speed over the floor of planted ankles at the seam, m/s,
  double own_slip = 0.0;  ///< and of the same in the clips.
  double jump = 0.0;      ///< Largest speed of a planted ankle beyond that in either clip, m/s.
  std::vector<std::string> faults;  ///< What is wrong with it, a phrase each; none: it is good.
};

/// Two clips as one.
struct Concatenation {
  Clip clip;
  Seam seam;
  SeamMap map;
  double lift = 0.0;  ///< By which b was raised to stand on a's floor, metres.
  double band = 0.0;  ///< That was searched in the end, seconds.
  SeamCheck check;
};

/// Joins b to a where they fit best (find_seam): frames of a up to the seam, then those of b, moved
/// over the ground to where a has come. The result has seam.a_frame + frames of b -
/// seam.b_frame frames. Where the floors of the clips differ, b is raised or lowered to a's floor
/// if the seam is the better for it (a clip cut in two on a stair stays as it was).
///
/// kCrossfade mixes the frames that both have from the seam on (at most the window): with k of them
/// a weighs 2 ((p + 1) / k)^3 - 3 ((p + 1) / k)^2 + 1 in the p-th; translations are mixed linearly,
/// local rotations the shorter way round. kInertial follows b from the seam on and adds to each
/// channel a cubic from the difference of values and velocities at the seam to rest; so does
/// kCrossfade where the clips share less than the window.
///
/// Where b begins one frame after a's end, as the parts of a clip do that was cut in two, and no
/// joint is too fast across the cut, the two are put together as they lie (seam.overlap is 0).
///
/// Feet that are planted near the seam are held by plant_feet: one that stands in both clips stays
/// where a has it until it leaves the floor. Then the seam is checked.
///
/// @param b  of the same skeleton and rate as a.
/// @return the clips as one; of a seam that is not good (check.faults) it is for the caller to
///     decide. kInput errors as find_seam and BodyMover::of, and for a clip b on another skeleton or
///     rate.
[[nodiscard]] Result<Concatenation> concatenate(const Clip& a, const Clip& b,
                                                const HumanMapping& mapping,
                                                const ConcatenateOptions& options,
                                                const std::string& a_file,
                                                const std::string& b_file);

}  // namespace retarget
