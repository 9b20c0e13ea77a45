#pragma once

#include <array>
#include <string>
#include <vector>

#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "human/contact_plan.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/pose.h"

// A seam of two clips, or of a clip with itself: found, blended, feet planted, checked.

namespace retarget {

/// Faults as what is said without stopping.
[[nodiscard]] std::vector<Warning> as_warnings(const std::vector<std::string>& faults);

struct SeamSearch {
  std::vector<Seam> seams;  ///< The best one, then the next best elsewhere; one at least.
  SeamMap map;
};

/// Finds where b goes on best from a: the least WindowDistance; see concatenate.
/// @pre both have frames, and bones in common
/// @return kUsage errors: more than 16 million pairs of frames to search.
[[nodiscard]] Result<SeamSearch> find_seam(const HumanClip& a, const HumanClip& b,
                                           const SeamOptions& options);

/// Whether b begins one frame after a's end, as the parts of a clip do that was cut in two and not
/// moved: of all spacings between the two, in steps of a quarter of a frame, one frame (half a frame
/// more or less) is that which makes the last four frames of a and the first four of b the
/// smoothest, by polynomials of fourth degree through the bones' positions. Clips of fewer frames,
/// and such as stand still, do not say.
[[nodiscard]] bool continues_motion(const HumanClip& a, const HumanClip& b);

/// How two clips share the frames around their seam, in frames of the result.
struct SeamRegion {
  int begin = 0, end = 0;  ///< Frames that neither clip has as they are.
  int a_end = 0;           ///< a counts in the frames before this one;
  int b_begin = 0;         ///< b from this one on,
  int b_shift = 0;         ///< whose frame f is frame f + b_shift.

  /// Weight of a in a frame.
  [[nodiscard]] double weight_of_a(int frame) const;
};

[[nodiscard]] SeamRegion seam_region(const Seam& seam, const ConcatenateOptions& options,
                                     const FrameRate& rate, int frames_of_b);

/// The clips as one; b lies already where it is to go on.
/// @param mover  of their skeleton.
[[nodiscard]] Clip blend_clips(const Clip& a, const Clip& b, const SeamRegion& region,
                               const Calibration& calibration, const BodyMover& mover);

/// The feet of one of two clips that are joined.
struct ClipFeet {
  std::array<std::vector<Pose>, 2> ankles;  ///< Where the clip lies in the result.
  ContactPlan contacts;
};

/// The motion over the ground that brings one place of a foot to another, heading and all.
[[nodiscard]] GroundPose between_places(const Pose& from, const Pose& to);

/// Where the feet stand in the joined clip: as in the clip they come from, but that a foot which
/// stands in both around the seam stays where a has it until it leaves the floor in b. A foot that
/// stands in one alone stands as long as the blend leaves it near the floor, and as that clip counts
/// more than the other.
/// @param blended  of the joined clip before feet are planted.
[[nodiscard]] std::vector<PlantedFoot> joined_plants(const ClipFeet& a, const ClipFeet& b,
                                                     const ClipFeet& blended,
                                                     const SeamRegion& region,
                                                     const FrameRate& rate);

/// Speeds and accelerations of the joints at a seam, against what the same joints do in both clips.
[[nodiscard]] SeamCheck check_motion(const HumanClip& a, const HumanClip& b,
                                     const HumanClip& joined, const SeamRegion& region,
                                     const MotionLimits& limits);

/// Fills in what planted feet do at a seam: slip and jump.
void check_feet(SeamCheck& check, const ClipFeet& a, const ClipFeet& b, const ClipFeet& joined,
                const std::vector<PlantedFoot>& plants, const SeamRegion& region,
                const FrameRate& rate);

/// Says what is wrong, in check.faults.
void find_faults(SeamCheck& check, const Seam& seam, const ConcatenateOptions& options);

/// A clip with the human and the feet in it.
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

/// Joins b to a at a seam: blends the frames around it, plants the feet and checks what became of
/// it.
/// @param b  where it goes on, of a's skeleton and rate.
/// @param mover  of their skeleton.
[[nodiscard]] Result<JoinedClips> join_clips(const HumanMotion& a, const HumanMotion& b,
                                             const Seam& seam, const Calibration& calibration,
                                             const BodyMover& mover,
                                             const ConcatenateOptions& options);

}  // namespace retarget
