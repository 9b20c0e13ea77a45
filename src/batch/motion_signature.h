#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// A coarse description of a motion, used to find the same motion in other files.
///
/// It has kSignatureRate samples per second in a frame that turns with the pelvis (y from the right
/// to the left hip joint, z towards the shoulders). A sample holds the directions of thighs, shins,
/// upper arms and forearms, left and right alternately, the up direction, and the hips' velocity in
/// leg lengths per second. Each value is a mean over kSignatureWindow seconds before and after with
/// triangular weights. So position, heading, size, unit, frame rate and names do not matter. Only
/// the first kSignatureMaxTime seconds of a clip are used.
struct MotionSignature {
  double seconds = 0.0;              ///< Length of the whole clip.
  std::vector<std::int8_t> samples;  ///< kSignatureNumbers per sample; empty: unknown.

  [[nodiscard]] std::size_t count() const;
};

inline constexpr std::size_t kSignatureVectors = 10;
inline constexpr std::size_t kSignatureNumbers = 3 * kSignatureVectors;
inline constexpr double kSignatureRate = 6.0;
inline constexpr double kSignatureWindow = 0.3;
inline constexpr double kSignatureMaxTime = 40.0;

/// Returns the signature of frames [begin, end) of a clip. Bones that the body lacks are zeros.
[[nodiscard]] MotionSignature motion_signature(const Clip& clip, const Calibration& calibration,
                                               int begin, int end);

[[nodiscard]] MotionSignature mirrored(const MotionSignature& signature);

/// Returns the difference of two motions in degrees: limb directions, and hip velocity at 20
/// degrees per leg length per second. It is the root mean square over the worst two seconds, with
/// the best time shift of up to kSignatureMaxShift seconds. Infinity if the lengths differ too much
/// or the difference exceeds `limit`, which is faster to find.
[[nodiscard]] double signature_distance(const MotionSignature& a, const MotionSignature& b,
                                        double limit = std::numeric_limits<double>::infinity());

inline constexpr double kSignatureMaxShift = 0.5;

/// Returns the tolerance in seconds for the lengths of one motion in two files.
[[nodiscard]] double signature_tolerance(double seconds);

/// Convert a signature to bytes and back; invalid bytes give an empty signature.
[[nodiscard]] std::string signature_bytes(const MotionSignature& signature);
[[nodiscard]] MotionSignature signature_from_bytes(std::string_view bytes);

}  // namespace retarget
