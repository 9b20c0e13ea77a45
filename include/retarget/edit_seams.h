#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/edited.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"

// Edits that join clips, or a clip to itself.

namespace RETARGET_API retarget {

struct SeamOptions {
  double window = 1.0 / 3.0;  ///< Length of the compared and blended interval, seconds.
  double band = 2.0;          ///< Search range at the end of a and at the beginning of b, seconds.
  bool search_all = false;    ///< Search both clips as a whole.
  /// Cost of dropping one second of either clip, metres of distance. Of equally good seams, the one
  /// that keeps most frames is chosen.
  double cost_of_second = 0.01;
  double cost_of_all =
      0.2;  ///< Cost of dropping all of both clips, in proportion to the dropped share.
  /// Relative penalty on the distance where different feet are in contact in the two clips.
  double other_support = 0.5;
  int max_seams = 4;  ///< Number of candidate seams that are tried.
};

/// The seam of two clips of one rate: frame a_frame of a coincides with frame b_frame of b.
struct Seam {
  int a_frame = 0, b_frame = 0;
  int overlap = 1;      ///< Frames that both clips share from the seam (at most the window).
  GroundPose a_from_b;  ///< Motion on the ground that takes b to a, about the world origin.
  Eigen::Vector2d way = Eigen::Vector2d::Zero();  ///< Displacement of b's hips at b_frame, metres.
  double distance = 0.0;                          ///< Root mean square over the bones, metres.
  bool same_support = true;     ///< Whether the same feet are in contact in both clips.
  std::string worst_bone;       ///< Bone farthest from its counterpart there.
  double worst_distance = 0.0;  ///< Distance of worst_bone, metres.
};

/// Distances of all searched windows. Rows are frames of a, columns frames of b; row-major.
struct SeamMap {
  int a_begin = 0, b_begin = 0;  ///< Frames of the first row and column.
  int width = 0;                 ///< Number of columns.
  std::vector<float> distances;  ///< Metres.
};

/// The map as an image (binary PGM, 8 bit): black is the smallest distance, white the largest.
[[nodiscard]] std::string format_pgm(const SeamMap& map);

/// Transition from one clip to the next.
enum class SeamBlend : std::uint8_t {
  kCrossfade,  ///< Blends both clips over the frames that they share.
  kInertial,   ///< Switches at once; the difference at the seam fades out in the second clip.
};

/// Joint speed and acceleration limits at a seam or on a path, as multiples of their 99.9th
/// percentile in the clips.
struct MotionLimits {
  double speed = 3.0;
  double acceleration = 3.0;
};

struct ConcatenateOptions {
  SeamOptions seam;
  /// If there is no good seam within seam.band, the range is doubled repeatedly up to this value,
  /// seconds, because recordings often begin with seconds of a T-pose.
  double widest_band = 32.0;
  SeamBlend blend = SeamBlend::kCrossfade;
  double fade = 0.35;      ///< Duration of the fade of kInertial, seconds.
  double threshold = 0.2;  ///< Largest distance of a seam, metres.
  MotionLimits limits;     ///< Limits of the joints at the seam.
  /// Largest mean speed over the floor of planted feet at the seam, m/s, in excess of their slip in
  /// the clips.
  double slip = 0.1;
  double jump = 0.5;  ///< Largest excess speed of a planted foot at the seam, m/s.
  /// If the floors of the clips are farther apart than this, metres, one common floor is tried too.
  double same_floor = 0.02;
  PlantOptions plant;

  /// Sets the search range from text: a number of seconds, or `all` for both clips as a whole,
  /// which prefers a good seam to one that keeps all of both clips. Empty text changes nothing;
  /// other texts are kUsage errors.
  [[nodiscard]] Result<void> search(std::string_view text);
};

/// Quality of a seam.
struct SeamCheck {
  double usual_speed = 0.0;    ///< 99.9th percentile of joint speeds in the clips, m/s: that of
                               ///< fastest_bone, or of all joints if this is smaller.
  double largest_speed = 0.0;  ///< Speed of fastest_bone at the seam, m/s.
  std::string fastest_bone;    ///< Joint with the largest speed relative to its usual speed.
  double usual_acceleration = 0.0;    ///< Like usual_speed, for accelerations, m/s^2.
  double largest_acceleration = 0.0;  ///< Acceleration of jolted_bone, m/s^2. Accelerations that a
                                      ///< clip itself has at that time are ignored.
  std::string jolted_bone;
  double slip = 0.0;      ///< Mean speed over the floor of planted ankles at the seam, m/s.
  double own_slip = 0.0;  ///< Mean speed over the floor of planted ankles within the clips, m/s.
  double jump = 0.0;      ///< Largest speed of a planted ankle beyond that in either clip, m/s.
  std::vector<std::string> faults;  ///< Faults of the seam, one phrase each; empty: it is good.
};

/// Two joined clips.
struct Concatenation : Edited {
  Seam seam;
  SeamMap map;
  double lift = 0.0;  ///< Distance by which b was raised to a's floor, metres.
  double band = 0.0;  ///< Final search range, seconds.
  SeamCheck check;
};

/// Joins b to a at the best seam: frames of a up to the seam, then those of b, moved over the
/// ground to the end of a. The result has seam.a_frame + frames of b - seam.b_frame frames. If the
/// floors of the clips differ, b is raised or lowered to a's floor if that improves the seam; a
/// clip that was cut in two on a stair is therefore not changed.
///
/// The seam minimises the distance of Kovar, Gleicher and Pighin (2002) over windows of bone
/// positions, with equal weights and the best rotation and translation of each window on the
/// ground. If the clips share less than a window, the distance is increased by half the missing
/// share. It is also increased if different feet are in contact. Frames that both clips contain, at
/// the end of a and the beginning of b, are found first.
///
/// kCrossfade blends the frames that both clips have after the seam (at most the window). With k
/// such frames, the weight of a in frame p is 2 ((p + 1) / k)^3 - 3 ((p + 1) / k)^2 + 1.
/// Translations are blended linearly, local rotations along the shorter arc. kInertial plays b from
/// the seam and adds to each channel a cubic that decays from the difference of values and
/// velocities at the seam to zero. kCrossfade does the same if the clips share less than the
/// window.
///
/// If b begins one frame after a's end, as when a clip was cut in two, and no joint is too fast
/// across the cut, the clips are joined without a change (seam.overlap is 0).
///
/// Feet that are in contact near the seam stay there: a foot that stands in both clips keeps its
/// position in a until it leaves the floor. Then the seam is checked; a bad seam is a misfit.
///
/// @param b  has the skeleton and rate of a (like_first).
/// @param a_name, b_name  names of the clips for messages.
/// @return kInput errors: a clip without frames, b on another skeleton or rate; errors of
///     turn_clip. kUsage errors: more than 16 million pairs of frames to search.
[[nodiscard]] Result<Concatenation> concatenate(const Clip& a, const Clip& b,
                                                const Calibration& calibration,
                                                const ConcatenateOptions& options,
                                                const std::string& a_name,
                                                const std::string& b_name);

/// Converts a clip to the skeleton and rate of another one, so that the two can be joined. The clip
/// is transferred if skeletons or calibrations differ. Errors as change_timing.
[[nodiscard]] Result<Edited> like_first(const Subject& next, const Subject& first);

struct LoopOptions {
  double shortest = 0.0;    ///< Minimum length of the cycle, seconds; 0: half the clip.
  ConcatenateOptions seam;  ///< Join of end and beginning, and limits of a good seam.
  bool in_place = false;    ///< The cycle neither advances nor turns.
  int times = 1;            ///< Number of repetitions of the cycle.
};

/// A seamless cycle. The clip has `cycle` frames per repetition; the frame after them would be the
/// first one again.
struct Loop : Edited {
  int cycle = 0;          ///< Frames of one cycle: those of the source from its first frame, except
                          ///< around the seam.
  double distance = 0.0;  ///< Distance between beginning and end before they were joined; see
                          ///< Seam::distance.
  GroundPose advance;     ///< Motion on the ground per cycle, before `in_place`, about the world
                          ///< origin.
  Eigen::Vector2d way = Eigen::Vector2d::Zero();  ///< Displacement of the hips per cycle, metres.
  SeamCheck check;                                ///< Check of the seam of end and beginning.
};

/// Makes a cycle from the first frame to the most similar frame at `shortest` or later. The clip is
/// joined to itself there as in `concatenate`: frames around the seam are blended, planted feet
/// stay in place, and the seam is checked. Positions and velocities of all joints are continuous
/// from each cycle to the next. If a foot is in contact throughout the cycle, the advance keeps it
/// in place.
/// @return kInput errors: fewer than 4 frames, or than `shortest` needs; errors of turn_clip.
///     kUsage errors: `times` below 1, or more than 10 million frames in total.
[[nodiscard]] Result<Loop> make_loop(const Clip& clip, const Calibration& calibration,
                                     const LoopOptions& options);

}  // namespace retarget
