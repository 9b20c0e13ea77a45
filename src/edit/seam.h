#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "retarget/clip.h"
#include "retarget/contact_plan.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/pose.h"

// A seam between two clips, or of a clip with itself: search, blending, foot planting, checks.

namespace retarget {

/// Converts faults to warnings, which do not stop the program.
[[nodiscard]] std::vector<Warning> as_warnings(const std::vector<std::string>& faults);

/// A seam drops at most this share of each clip.
inline constexpr double kMostLost = 0.9;

struct SeamSearch {
  std::vector<Seam> seams;  ///< The best seam, then the next best ones elsewhere; at least one.
  bool first_is_shared = false;  ///< Whether, at the first seam, the end of a is the beginning of
                                 ///< b.
  SeamMap map;
};

/// Finds the best transition from a to b, the one with the smallest WindowDistance; see
/// concatenate.
/// @param any_overlap  find equal frames at a's end and b's beginning also if there are more of
///                     them than options.band.
/// @pre Both have frames, and bones in common.
/// @return kUsage errors: more than 16 million pairs of frames to search.
[[nodiscard]] Result<SeamSearch> find_seam(const HumanClip& a, const HumanClip& b,
                                           const SeamOptions& options, bool any_overlap);

/// Returns true if b begins one frame after a's end, as for a clip that was cut in two and not
/// moved. Tests all spacings between the clips in steps of a quarter of a frame. The spacing that
/// gives the smoothest fit of fourth-degree polynomials to the bone positions in the last four
/// frames of a and the first four of b must be one frame, plus or minus half a frame. Returns false
/// for clips with fewer frames and for clips that stand still.
[[nodiscard]] bool continues_motion(const HumanClip& a, const HumanClip& b);

/// Frame ranges of two clips around their seam, in frames of the result.
struct SeamRegion {
  int begin = 0, end = 0;  ///< Frames that differ from both clips.
  int a_end = 0;           ///< Clip a contributes before this frame.
  int b_begin = 0;         ///< First frame that clip b contributes to.
  int b_shift = 0;         ///< Frame f of b is frame f + b_shift of the result.

  /// Returns the weight of a in a frame.
  [[nodiscard]] double weight_of_a(int frame) const;
};

[[nodiscard]] SeamRegion seam_region(const Seam& seam, const ConcatenateOptions& options,
                                     const FrameRate& rate, int frames_of_b);

/// Blends the clips into one; b must already be in its final position.
/// @param mover  mover of the clips' skeleton.
[[nodiscard]] Clip blend_clips(const Clip& a, const Clip& b, const SeamRegion& region,
                               const Calibration& calibration, const BodyMover& mover);

/// The feet of one of two joined clips.
struct ClipFeet {
  std::array<std::vector<Pose>, 2> ankles;  ///< Ankle poses, in the clip's position within the
                                            ///< result.
  ContactPlan contacts;
};

/// Returns the motion over the ground, including heading, between two poses of a foot.
[[nodiscard]] GroundPose between_places(const Pose& from, const Pose& to);

/// Returns the foot plants of the joined clip. Plants come from the source clips, except that a
/// foot that stands in both clips around the seam keeps a's position until it lifts off in b. A
/// foot that stands in only one clip is planted while the blend leaves it near the floor and its
/// clip has the larger weight.
/// @param blended  feet of the joined clip before planting.
[[nodiscard]] std::vector<PlantedFoot> joined_plants(const ClipFeet& a, const ClipFeet& b,
                                                     const ClipFeet& blended,
                                                     const SeamRegion& region,
                                                     const FrameRate& rate);

/// Compares joint speeds and accelerations at a seam with those in both clips.
[[nodiscard]] SeamCheck check_motion(const HumanClip& a, const HumanClip& b,
                                     const HumanClip& joined, const SeamRegion& region,
                                     const MotionLimits& limits);

/// Measures slip and jumps of planted feet at a seam, into `check`.
void check_feet(SeamCheck& check, const ClipFeet& a, const ClipFeet& b, const ClipFeet& joined,
                const std::vector<PlantedFoot>& plants, const SeamRegion& region,
                const FrameRate& rate);

/// Describes faults in check.faults.
void find_faults(SeamCheck& check, const Seam& seam, const ConcatenateOptions& options);

/// A clip with its human and foot data.
struct HumanMotion {
  const Clip& clip;
  HumanClip human;
  ClipFeet feet;

  HumanMotion(const Clip& of, const Calibration& calibration);
};

struct JoinedClips {
  Clip clip;
  SeamCheck check;
};

/// Joins b to a at a seam: blends the frames around it, plants the feet and checks the result.
/// @param b      clip in its final position, with a's skeleton and rate.
/// @param mover  mover of their skeleton.
[[nodiscard]] Result<JoinedClips> join_clips(const HumanMotion& a, const HumanMotion& b,
                                             const Seam& seam, const Calibration& calibration,
                                             const BodyMover& mover,
                                             const ConcatenateOptions& options);

/// Evaluates a cubic Hermite curve over `frames` frames at frame `at`: from `begin` with velocity
/// `begin_velocity` to `end` with `end_velocity` (per frame).
[[nodiscard]] inline Eigen::Vector3d ease(const Eigen::Vector3d& begin,
                                          const Eigen::Vector3d& begin_velocity,
                                          const Eigen::Vector3d& end,
                                          const Eigen::Vector3d& end_velocity, double frames,
                                          double at) {
  const double u = at / frames, left = 1.0 - u;
  return begin * (left * left * (1.0 + 2.0 * u)) + begin_velocity * (frames * u * left * left) +
         end * (u * u * (1.0 + 2.0 * left)) - end_velocity * (frames * left * u * u);
}

/// Evaluates the cubic from `begin` to rest at zero: fades out an offset.
[[nodiscard]] inline Eigen::Vector3d fade(const Eigen::Vector3d& begin,
                                          const Eigen::Vector3d& begin_velocity, double frames,
                                          double at) {
  const Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  return at >= frames ? rest : ease(begin, begin_velocity, rest, rest, frames, at);
}

/// Returns the number of frames in a duration, at least one.
[[nodiscard]] inline int frames_in(double seconds, const FrameRate& rate) {
  constexpr double kMaxSeconds = 1e5;
  return std::max(1, static_cast<int>(std::lround(std::min(seconds, kMaxSeconds) * rate.fps())));
}

}  // namespace retarget
