#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/scene.h"

// Edits of clips, as in `retarget edit` (docs/editing.md) and with the same defaults.
//
// Most edits work on the human in a clip and take its calibration, computed from the whole clip.
// Errors about a single clip name no file because the caller knows it.

namespace RETARGET_API retarget {

/// A line of an edit's report: a short label and text. An empty label continues the previous line.
struct EditNote {
  std::string label, text;
};

/// An edited clip and a report about it.
struct Edited {
  Clip clip;
  std::vector<EditNote> notes = {};
  std::vector<Warning> doubts = {};  ///< Possible errors in the clip.
  /// Reason why a seam is bad (kRun). The clip can still be used.
  std::optional<Error> misfit = std::nullopt;
};

/// References to a clip and the human in it.
struct Subject {
  const Clip& clip;
  const BoneMap& map;
  const Calibration& calibration;
  std::string name = {};  ///< Name of the clip in messages about two clips.
};

// --- time ---

struct TimingOptions {
  std::optional<FrameRate> rate = {};  ///< Empty: the source's.
  std::optional<double> speed = {};    ///< Playback speed factor, 0.01 to 100.
  bool linear = false;    ///< Linear interpolation and slerp between source frames, not splines.
  bool antialias = true;  ///< Low-pass filter a source with a higher rate than the output.
};

/// Changes frame rate and speed of a clip: frame i is the source at the time i * speed / rate. One
/// resampling does both, with the source as a clip at `speed` times its rate. Times are therefore
/// exact, and faster motion is low-pass filtered first.
/// @return kUsage errors: a speed out of range. kInput errors: an implausible number of samples.
[[nodiscard]] Result<Clip> change_timing(Clip clip, const TimingOptions& options);

/// An interval of a clip, given by times or by frames; by default the whole clip.
/// @return kUsage errors: both times and frames given, a part without frames.
[[nodiscard]] Result<Clip> trim(Clip clip, const PartOptions& part);

/// Removes leading frames that are not part of the motion: a T-pose or an all-zero frame, followed
/// by a jump. Call this before edits that use the whole motion: put_on_floor, make_loop,
/// concatenate, follow_path. Adds a note if frames were dropped.
/// @param can_start  whether the note mentions the option that keeps these frames.
[[nodiscard]] Edited cut_lead_in(Clip clip, bool can_start = true);

/// Human-readable summary: frames, rate, seconds.
[[nodiscard]] std::string summary(const Clip& clip);

// --- skeleton ---

/// A clip on another skeleton, and the resulting error.
struct RestChange : Edited {
  /// Largest displacement of a joint or end site in any frame, file units. It is 0 up to rounding
  /// if bone lengths agree and the bones that start at each joint form the same angles in both
  /// skeletons.
  double largest_distance = 0.0;
};

/// Transfers the movement to a skeleton with other rest directions (A-pose to T-pose), joint order
/// or channels. Joints are matched by name and must form the same tree.
///
/// With R the local rotations and Q_i the rotation from the rest directions of joint i's children
/// and end sites in the source to those in the target,
///     R_target,i = Q_parent(i) R_source,i Q_i^-1.
/// Q is the identity above the root and for joints without children and end sites. The world
/// rotation of joint i is then that of the source times Q_i^-1, and its children keep their
/// directions. Q_i is the minimal rotation for one direction, the least-squares rotation (Kabsch)
/// for several. Translations stored per frame keep their world value; bone lengths are the
/// target's.
///
/// @param file, target_file  names of the clip and of the target, for messages.
/// @return kInput errors: joints that are missing, duplicated, or have another parent.
[[nodiscard]] Result<RestChange> change_rest(const Clip& clip,
                                             const std::shared_ptr<const Skeleton>& target,
                                             const std::string& file,
                                             const std::string& target_file);

/// Corrections of feet and hips that planted the feet, metres.
struct PlantSummary {
  double largest_correction = 0.0;  ///< Displacement of an ankle.
  double largest_drop = 0.0;        ///< Lowering of the hips.
  double largest_miss = 0.0;        ///< Distance to a position that a leg cannot reach.
};

/// A clip on another body.
struct Transferred : Edited {
  std::vector<std::string> left_out;  ///< Moving joints of the source without a counterpart.
  std::vector<std::string> at_rest;   ///< Joints of the target that keep their rest rotation.
  std::optional<PlantSummary> feet;   ///< Empty: the feet could not be planted.
};

/// Transfers a human's movement to another skeleton, through the T-pose. With the world rotations
/// S_T and G_T of source and target in their T-poses, each mapped joint has the rotation R_target =
/// R_source S_T^-1 G_T. Both are the T-pose of the canonical human, so this is the rotation of the
/// canonical bone times the inverse of the target's joint_from_bone.
///
/// The path of the hips is scaled by the ratio of the body sizes (Calibration::size, which depends
/// on leg lengths) and raised by the extra distance from hips to soles, so that a standing body
/// stays on the floor. It is stored in the hips, or in the root if the hips have no position
/// channels.
///
/// Joints that are not bones (fingers, a second neck joint, helpers) copy the rotations and the
/// scaled translations of their counterpart in the source: a joint of the same name below a joint
/// of the same name. Joints without a counterpart keep their rest rotation (zero). Joint order,
/// offsets and channels are the target's.
///
/// Bodies with different proportions would slide in stances, so feet are then planted: each foot
/// that stands on its toes, sole or heel slides no more than the source's, in proportion, and keeps
/// its height above the floor.
[[nodiscard]] Transferred transfer(const Subject& source, const Subject& target);

/// Converts a human's movement to a clip on LAFAN1's skeleton: its 22 joints in its order, names
/// and axes, centimetres, y up, rotations z y x. Programs that read LAFAN1 can then read any
/// source.
///
/// The body and its path over the floor are scaled to the size that readers of LAFAN1 assume
/// (Calibration::size becomes 1.75 m). Offsets are the mean positions of the bones over the clip,
/// which preserves the source's proportions. Joints that the source lacks are at their parents and
/// rotate with them.
/// @return a kInput error if the hips, a leg or an arm is missing.
[[nodiscard]] Result<Clip> lafan1_clip(const Clip& clip, const Calibration& calibration);

/// The mirrored movement on the same skeleton: left and right are exchanged. The mirror plane is
/// vertical, contains the heading of the first frame and passes through its hips, so the clip
/// begins at the same position. Mirroring twice gives the original clip. Joints are paired by the
/// calibration, then by position and shape; their names do not matter.
///
/// With W the world rotation of a joint, M the mirror and S the reflection between the axes of the
/// joint and of its counterpart, the world rotation of the counterpart is M W S^-1. S comes from
/// the zero pose if that is its own mirror image, as in most skeletons; otherwise from the T-pose,
/// or, if the T-pose is a guess, from the nearest reflection of axes.
/// @return a kInput error that names a joint without a counterpart; errors of turn_clip.
[[nodiscard]] Result<Clip> mirror(const Clip& clip, const Calibration& calibration);

/// A mirrored clip, and the calibration with which its human is the mirror image of the original's.
struct MirroredHuman {
  Clip clip;
  Calibration calibration;
};

/// mirror() for a clip whose calibration is kept. Rotations that a calibration learned, or took
/// from a pose that is only nearly a T-pose, may be asymmetric: with the calibration of the
/// original, such errors would have the same sign in both clips, instead of opposite signs.
[[nodiscard]] Result<MirroredHuman> mirror_human(const Clip& clip, const Calibration& calibration);

/// The plane of mirror() and mirror_human(), for the scene of a clip.
/// @param clip  at least one frame.
[[nodiscard]] MirrorPlane mirror_plane(const Clip& clip, const Calibration& calibration);

// --- place ---

/// Rotates the clip about the vertical through its hips in the first frame.
/// @param angle  radians, positive to the left.
/// @return a kInput error if no joint moves the whole body.
[[nodiscard]] Result<Clip> turn_clip(Clip clip, const Calibration& calibration, double angle);

/// Moves the clip over the ground by `way`, metres along the axes of GroundPose. Errors as
/// turn_clip.
[[nodiscard]] Result<Clip> move_clip(Clip clip, const Calibration& calibration,
                                     const Eigen::Vector2d& way);

/// Parses `X,Y`, metres. Other texts are kUsage errors.
[[nodiscard]] Result<Eigen::Vector2d> way_from_text(std::string_view text);

/// Height of the floor under a human, metres: the median, over the frames in which a foot is in
/// contact, of the lowest of that foot's joints and end sites. In a clip shorter than a contact, a
/// foot that does not move counts as in contact; in a single frame, the lower foot does.
/// @return a kInput error if no foot is ever in contact.
[[nodiscard]] Result<double> floor_height(const Clip& clip, const Calibration& calibration);

/// Raises or lowers the clip so that the floor is at height 0. Errors as turn_clip.
/// @param floor  present height of the floor, metres.
[[nodiscard]] Result<Clip> put_on_floor(Clip clip, const Calibration& calibration, double floor);

/// Parameters of planting feet at their contacts.
struct PlantOptions {
  /// Duration of the blend between a foot's contact and its unplanted position, seconds.
  double release = 0.3;
  double pelvis_blend = 0.25;  ///< Blend before and after a frame with lowered hips, seconds.
};

// --- seams ---

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

// --- the way over the ground ---

struct PathFitOptions {
  double tolerance = 0.05;   ///< Largest distance of the curve from the track, metres.
  double low_pass = 0.5;     ///< Cut-off frequency for the track of the hips, Hz; removes sway.
  double still_step = 0.03;  ///< Shortest step of the track, metres.
  double first_piece = 2.0;  ///< Length of the initial segments, metres.
  double min_piece = 0.25;   ///< Minimum length of a segment after splitting, metres.
  double still_speed = 0.1;  ///< A body below this speed has no direction of travel, m/s.
};

/// Frames [begin, end) in which the body stays in place.
struct StillPhase {
  int begin = 0, end = 0;
  double turn = 0.0;  ///< Turn of the hips from the frame before to the frame after, radians.
};

/// The path of a human over the ground, and the motion along it.
struct PathMotion {
  GroundPath path;
  std::vector<double> along;  ///< Metres along the path, per frame; never decreasing.
  std::vector<StillPhase> still;
  double largest_distance = 0.0;  ///< Distance of the path from the smoothed track, metres.

  /// Human-readable summary: length, segments, distance from the track.
  [[nodiscard]] std::string summary() const;
};

/// Fits a path to the track of the hips (Gleicher: Motion Path Editing, 2001).
///
/// The track is low-pass filtered without delay and thinned to steps of `still_step`, so that
/// standing still adds no path. A least-squares fit gives a chain of cubics, parametrised by chord
/// length, with one tangent at each joint and therefore without corners. Segments whose distance
/// from the track exceeds the tolerance are split, and the fit is repeated. A body that stays
/// within one step gets a path of one millimetre in the direction that it faces.
/// @return a kInput error for a clip without frames.
[[nodiscard]] Result<PathMotion> fit_path(const Clip& clip, const Calibration& calibration,
                                          const PathFitOptions& options = {});

/// The path that replaces the motion's own path. It begins where the own path begins, unless it is
/// read from a file.
struct PathChange {
  std::string to = {};   ///< `line`, `circle` or `figure8`, with the length of the own path; a JSON
                         ///< file; or empty for the own path.
  double radius = 3.0;   ///< Radius of a circle, metres; negative: to the right.
  double scale = 1.0;    ///< Scale about the beginning of the path.
  double degrees = 0.0;  ///< Rotation about the beginning of the path, positive to the left.

  [[nodiscard]] bool any() const { return !to.empty() || scale != 1.0 || degrees != 0.0; }
  /// @return a kUsage error for a radius below a centimetre.
  [[nodiscard]] Result<void> check() const;
};

/// Applies a change to a motion's own path.
/// @return kUsage errors of PathChange::check, kConfig errors of a path file.
[[nodiscard]] Result<GroundPath> change_path(const GroundPath& own, const PathChange& change);

/// Quantity that does not change when a path becomes longer or shorter.
enum class PathKeep : std::uint8_t {
  kTime,    ///< Duration: the motion covers the whole path in the same time.
  kSpeed,   ///< Speed over the ground: a longer path takes longer.
  kStride,  ///< Distance along the path per frame: the motion ends after the length of its own
            ///< path, or continues straight beyond the end of the new one.
};

struct FollowPathOptions {
  PathKeep keep = PathKeep::kTime;
  PathFitOptions fit;
  MotionLimits limits;  ///< Limits of the joints.
};

/// A motion on another path.
struct FollowedPath : Edited {
  PathMotion source;               ///< The motion's own path.
  std::vector<GroundPose> frames;  ///< Poses along the new path, per frame of the source.
  PlantSummary feet;
  SeamCheck check;  ///< Speeds and accelerations in the whole clip; faults if the path is too
                    ///< fast.
};

/// Maps a motion to another path. The body keeps its pose relative to the frame F that moves
/// along the path (position and tangent), so the body at s(t) on its own path moves by
/// F'(s'(t)) F(s(t))^-1. Corners of a path are turned at no more than 4 rad/s. Only the channels
/// that move the whole body change. Standing feet are then planted at the position in the middle
/// frame of each contact.
/// @return kInput errors of fit_path and turn_clip; kUsage errors: kSpeed for a motion that stays
///     in place or for a path more than 100 times longer or shorter.
[[nodiscard]] Result<FollowedPath> follow_path(const Clip& clip, const Calibration& calibration,
                                               const GroundPath& path,
                                               const FollowPathOptions& options);

/// A motion and the path that it follows, for draw_paths. Either may be null.
struct PathDrawing {
  const Clip* clip = nullptr;
  const GroundPath* path = nullptr;
};

/// Draws motions of one human from above as SVG: the track of the hips, the path with its control
/// points, and the positions of standing feet (toes if there are any; left and right have different
/// colours). x points to the right, y up, with a scale bar. The first motion is paler than the
/// others.
[[nodiscard]] std::string draw_paths(const Calibration& calibration,
                                     const std::vector<PathDrawing>& drawings);

}  // namespace retarget
