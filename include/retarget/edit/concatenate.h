#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/edit/find_seam.h"
#include "retarget/edit/plant_feet.h"
#include "retarget/human/human_clip.h"
#include "retarget/motion/clip.h"

namespace retarget {

/// How one clip becomes the next.
enum class SeamBlend : std::uint8_t {
  kCrossfade,  ///< Both are mixed over the frames that they share.
  kInertial,   ///< At once; what the second lacks to the first fades in it.
};

struct ConcatenateOptions {
  SeamOptions seam;
  SeamBlend blend = SeamBlend::kCrossfade;
  double fade = 0.35;         ///< Of kInertial: how long the difference fades, seconds.
  double threshold = 0.2;     ///< Largest distance of a seam, metres.
  double speed_factor = 3.0;  ///< Joints at the seam against the clips' 99.9th percentile.
  double slip = 0.1;          ///< Of planted feet at the seam: mean speed over the floor, m/s.
  bool force = false;         ///< Join whatever the seam is like.
  PlantOptions plant;
};

/// What a seam became.
struct SeamCheck {
  double usual_speed = 0.0;    ///< 99.9th percentile of the clips' joint speeds, m/s.
  double largest_speed = 0.0;  ///< Of the joints at the seam, m/s,
  std::string fastest_bone;    ///< and whose it is.
  double slip = 0.0;           ///< Mean speed over the floor of planted ankles at the seam, m/s.
  std::vector<std::string> faults;  ///< What is wrong with it, a phrase each; none: it is good.
};

/// Two clips as one.
struct Concatenation {
  Clip clip;
  Seam seam;
  SeamMap map;
  SeamCheck check;
};

/// Joins b to a where they fit best (find_seam): frames of a up to the seam, then those of b, moved
/// over the ground to where a has come. The result has seam.a_frame + frames of b -
/// seam.b_frame frames.
///
/// kCrossfade mixes the frames that both have from the seam on (at most the window): with k of
/// them a weighs 2 ((p + 1) / k)^3 - 3 ((p + 1) / k)^2 + 1 in the p-th; translations are mixed
/// linearly, local rotations the shorter way round. kInertial follows b from the seam on and adds
/// to each channel a cubic from the difference of values and velocities at the seam to rest; so does
/// kCrossfade where the clips share less than the window.
///
/// Feet that are planted near the seam are held by plant_feet: one that stands in both clips stays
/// where a has it until it leaves the floor. Then the seam is checked.
///
/// @param b  of the same skeleton and rate as a.
/// @return kInput errors as find_seam and BodyMover::of, and for a clip b on another skeleton or
///     rate; kRun errors saying what is wrong with the seam, without `force`.
[[nodiscard]] Result<Concatenation> concatenate(const Clip& a, const Clip& b,
                                                const HumanMapping& mapping,
                                                const ConcatenateOptions& options,
                                                const std::string& a_file,
                                                const std::string& b_file);

}  // namespace retarget
