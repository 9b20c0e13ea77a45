#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// What a movement looks like, coarsely: to find the same one again in other files.
///
/// kSignatureRate times a second, in a frame that turns with the pelvis (y from the right hip joint to the
/// left, z towards the shoulders): directions of thighs, shins, upper arms and forearms, left and right
/// in turn, the direction that is up, and the velocity of the hips in lengths of the leg per second. Each is
/// a mean over kSignatureWindow seconds before and after, weighted by a triangle. So place, heading,
/// size, unit, frame rate and names do not matter. Of long clips the first kSignatureMaxTime seconds count.
struct MotionSignature {
  double seconds = 0.0;              ///< The clip's length, all of it.
  std::vector<std::int8_t> samples;  ///< kSignatureNumbers for each time; empty: not known.

  [[nodiscard]] std::size_t count() const;
};

inline constexpr std::size_t kSignatureVectors = 10;
inline constexpr std::size_t kSignatureNumbers = 3 * kSignatureVectors;
inline constexpr double kSignatureRate = 6.0;
inline constexpr double kSignatureWindow = 0.3;
inline constexpr double kSignatureMaxTime = 40.0;

/// The signature of frames [begin, end) of a clip. Bones that the body lacks are zeros.
[[nodiscard]] MotionSignature motion_signature(const Clip& clip, const Calibration& calibration,
                                               int begin, int end);

/// Of the mirror image.
[[nodiscard]] MotionSignature mirrored(const MotionSignature& signature);

/// How different two movements are, degrees: directions of limbs, the hips' velocity at 20 degrees for a
/// leg's length per second; root mean square over the worst two seconds, with the one moved in time
/// against the other by up to kSignatureMaxShift seconds as fits best. Infinity where they are not of
/// about the same length, and where they are farther apart than `limit`, which is found sooner.
[[nodiscard]] double signature_distance(const MotionSignature& a, const MotionSignature& b,
                                        double limit = std::numeric_limits<double>::infinity());

inline constexpr double kSignatureMaxShift = 0.5;

/// By how many seconds the lengths of one movement may differ in two files.
[[nodiscard]] double signature_tolerance(double seconds);

/// A signature as bytes, and back; an empty one for what is none.
[[nodiscard]] std::string signature_bytes(const MotionSignature& signature);
[[nodiscard]] MotionSignature signature_from_bytes(std::string_view bytes);

}  // namespace retarget
