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

// What `retarget edit` does: clips in, clips out (docs/editing.md). Defaults are the command's.
//
// Most edits need the human in a clip and take its calibration, as recognition and calibration found it
// in the whole clip. Errors about a single clip name no file: the caller knows which one it is.

namespace RETARGET_API retarget {

/// A line of an edit's report: a short label (empty: continues the previous line) and text.
struct EditNote {
  std::string label, text;
};

/// An edited clip and a report about it.
struct Edited {
  Clip clip;
  std::vector<EditNote> notes = {};
  std::vector<Warning> doubts = {};  ///< What may be wrong with it.
  /// Why a seam is not good (kRun). The clip can still be used.
  std::optional<Error> misfit = std::nullopt;
};

/// References to a clip and the human in it.
struct Subject {
  const Clip& clip;
  const BoneMap& map;
  const Calibration& calibration;
  std::string name = {};  ///< In messages about two clips.
};

// --- time ---

struct TimingOptions {
  std::optional<FrameRate> rate = {};  ///< Empty: the source's.
  std::optional<double> speed = {};    ///< Playback speed factor, 0.01 to 100.
  bool linear = false;    ///< Linear interpolation and slerp between source frames, not splines.
  bool antialias = true;  ///< Low-pass a source that is faster than the output.
};

/// The clip at another frame rate, or faster or slower: frame i is the source at the time
/// i * speed / rate. Both are done in one resampling, treating the source as a clip at speed times
/// its rate: times are exact, and faster motion is low-passed first.
/// @return kUsage errors: a speed out of range. kInput errors: an implausible number of samples.
[[nodiscard]] Result<Clip> change_timing(Clip clip, const TimingOptions& options);

/// A part of a clip, by times or by frames. By default the whole clip.
/// @return kUsage errors: both times and frames given, a part without frames.
[[nodiscard]] Result<Clip> trim(Clip clip, const PartOptions& part);

/// The clip without leading frames that are not part of its motion: a T-pose or an all-zero frame
/// that it jumps away from. Call this before edits that look at the motion as a whole:
/// put_on_floor, make_loop, concatenate, follow_path. Adds a note if frames were dropped.
/// @param can_start  whether the note mentions the option that keeps them.
[[nodiscard]] Edited cut_lead_in(Clip clip, bool can_start = true);

/// Human-readable: frames, rate, seconds.
[[nodiscard]] std::string summary(const Clip& clip);

// --- skeleton ---

/// A clip on another skeleton, and how well it fits.
struct RestChange : Edited {
  /// Largest distance, over joints, end sites and frames, between where they are and where they
  /// were; file units. 0 up to rounding if bone lengths agree and the bones leaving each joint form
  /// the same angles in both skeletons.
  double largest_distance = 0.0;
};

/// The same movement on a skeleton with other rest directions (A-pose to T-pose), joint order or
/// channels. Joints are matched by name and must form the same tree.
///
/// With R the local rotations and Q_i the rotation that takes the rest directions of what leaves
/// joint i (children and end sites) from the source to the target,
///     R_target,i = Q_parent(i) R_source,i Q_i^-1,
/// Q being the identity above the root and for joints that nothing leaves. Then the world rotation
/// of joint i is that of the source times Q_i^-1, and what leaves it points as before. Q_i is the
/// minimal rotation for one direction, the best by least squares (Kabsch) for several.
/// Translations stored per frame keep their world value; bone lengths are the target's.
///
/// @param file, target_file  of the clip and of the target, for messages.
/// @return kInput errors: joints that are missing, duplicated, or below another parent.
[[nodiscard]] Result<RestChange> change_rest(const Clip& clip,
                                             const std::shared_ptr<const Skeleton>& target,
                                             const std::string& file,
                                             const std::string& target_file);

/// How far feet and hips were moved to plant the feet, metres.
struct PlantSummary {
  double largest_correction = 0.0;  ///< Of an ankle.
  double largest_drop = 0.0;        ///< Of the hips.
  double largest_miss = 0.0;        ///< To a place that a leg cannot reach.
};

/// A clip on another body.
struct Transferred : Edited {
  std::vector<std::string> left_out;  ///< Joints of the source that move and have no counterpart.
  std::vector<std::string> at_rest;   ///< Joints of the target that stay as they are.
  std::optional<PlantSummary> feet;   ///< Empty: they could not be planted.
};

/// A human's movement on another skeleton, through the T-pose: with world rotations of source and
/// target in their T-poses S_T and G_T, each mapped joint turns by R_target = R_source S_T^-1 G_T.
/// Both sides know their T-pose as the canonical human's, so this is the canonical bone's rotation
/// times the inverse of the target's joint_from_bone.
///
/// The hips' path is scaled by the bodies' sizes (Calibration::size: leg lengths), raised by the
/// extra distance from hips to soles, so that a body that stood on the floor still does, and put on
/// the hips, or on the root above them where they have no position channels.
///
/// Joints that are not bones (fingers, a second neck joint, helpers) but have a counterpart in the
/// source, of the same name below a joint of the same name, turn as it does; their translations are
/// copied, scaled. The others keep their rest rotation (zero). Joint order, offsets and channels
/// are the target's.
///
/// Then feet are planted, as bodies of other proportions would slide where the source stands: each
/// foot that stands on its toes, sole or heel slides no more than the source's, in proportion, and
/// keeps its height above the floor.
[[nodiscard]] Transferred transfer(const Subject& source, const Subject& target);

/// A human's movement as a clip in the shape of LAFAN1: its 22 joints in its order, names and axes,
/// centimetres, y up, rotations z y x. Programs that read LAFAN1 can read any source this way.
///
/// The body is scaled to the size that readers of LAFAN1 assume (Calibration::size becomes 1.75
/// m); offsets are the means of the bones' places over the clip, so lengths are the source's own in
/// proportion. Joints that the source lacks stand at their parents and turn with them. The path
/// over the floor is scaled too.
/// @return a kInput error when the hips, a leg or an arm is missing.
[[nodiscard]] Result<Clip> lafan1_clip(const Clip& clip, const Calibration& calibration);

/// The movement of the mirror image, on the same skeleton: left does what right did. The mirror
/// stands upright along the heading of the first frame, at its hips, so that the clip begins where
/// it began; mirroring twice changes nothing. Joints are paired by the calibration, then by place and
/// shape; names play no part.
///
/// With W the world rotation of a joint, M the mirror and S the reflection between the axes of the
/// joint and of its counterpart, the counterpart's world rotation is M W S^-1. S comes from the
/// skeleton: most zero poses are their own mirror image; otherwise the T-pose is used, and where
/// that is guessed, the nearest reflection of axes.
/// @return a kInput error naming a joint without a counterpart; as turn_clip.
[[nodiscard]] Result<Clip> mirror(const Clip& clip, const Calibration& calibration);

// --- place ---

/// The clip, rotated about the vertical through its hips in the first frame; radians, positive to
/// the left.
/// @return a kInput error if no joint moves the whole body.
[[nodiscard]] Result<Clip> turn_clip(Clip clip, const Calibration& calibration, double angle);

/// The clip moved over the ground, metres along the axes of GroundPose. Errors as turn_clip.
[[nodiscard]] Result<Clip> move_clip(Clip clip, const Calibration& calibration,
                                     const Eigen::Vector2d& way);

/// What `X,Y` means, metres; else a kUsage error.
[[nodiscard]] Result<Eigen::Vector2d> way_from_text(std::string_view text);

/// Height of the floor that a human stands on, metres: the median, over the frames in which a foot
/// is in contact, of the lowest of that foot's joints and end sites. In a clip shorter than a contact,
/// a foot that stands still throughout counts as in contact; in a single frame, the lower one.
/// @return a kInput error if no foot is ever in contact.
[[nodiscard]] Result<double> floor_height(const Clip& clip, const Calibration& calibration);

/// The clip raised or lowered so that the floor is at height 0, which `floor` (metres) is now.
/// Errors as turn_clip.
[[nodiscard]] Result<Clip> put_on_floor(Clip clip, const Calibration& calibration, double floor);

/// How feet are moved to their contacts.
struct PlantOptions {
  /// Seconds over which a foot blends between its contact and where its leg would put it.
  double release = 0.3;
  /// Legs stretch freely up to this share of thigh and shin, then less and less up to
  /// max_reach; legs that were stretched farther before, from there up to their full length.
  double soft_reach = 0.96;
  double max_reach = 0.995;
  double pelvis_blend = 0.25;   ///< Before and after a frame in which the hips are low, seconds.
  double deepest_pelvis = 0.1;  ///< How far the hips are lowered at most, metres.
};

// --- seams ---

struct SeamOptions {
  double window = 1.0 / 3.0;  ///< Length of the part compared and blended, seconds.
  double band = 2.0;          ///< Searched at the end of a and at the beginning of b, seconds.
  bool search_all = false;    ///< Search both clips as a whole.
  /// Cost of dropping a second of either clip, metres of distance: of equally good seams, the one
  /// that keeps most wins.
  double cost_of_second = 0.01;
  double cost_of_all = 0.2;  ///< The same by the share of both clips that is left out, of all.
  /// Relative penalty on the distance where different feet are in contact in the two clips.
  double other_support = 0.5;
  int max_seams = 4;  ///< How many places are tried.
};

/// Where two clips of one rate fit together: frame a_frame of a meets b_frame of b.
struct Seam {
  int a_frame = 0, b_frame = 0;
  int overlap = 1;      ///< Frames shared by both clips from here on (at most the window).
  GroundPose a_from_b;  ///< Moves b over the ground to a: in the world, about its origin.
  Eigen::Vector2d way = Eigen::Vector2d::Zero();  ///< The same of b's hips at b_frame, metres.
  double distance = 0.0;                          ///< Root mean square over the bones, metres.
  bool same_support = true;                       ///< The same feet are in contact in both.
  std::string worst_bone;                         ///< Farthest from its counterpart at the seam,
  double worst_distance = 0.0;                    ///< by so many metres.
};

/// Distances of all searched windows, row by row: rows are frames of a.
struct SeamMap {
  int a_begin = 0, b_begin = 0;  ///< The frames of the first row and column.
  int width = 0;                 ///< Frames of b.
  std::vector<float> distances;  ///< Metres.
};

/// The map as a picture (binary PGM, 8 bit): black is the least distance, white the largest.
[[nodiscard]] std::string format_pgm(const SeamMap& map);

/// How one clip becomes the next.
enum class SeamBlend : std::uint8_t {
  kCrossfade,  ///< Blends both over the frames that they share.
  kInertial,   ///< Switches at once; the difference to the first fades out in the second.
};

/// What joints may do at a seam or on a path, times their 99.9th percentile in the clips.
struct MotionLimits {
  double speed = 3.0;
  double acceleration = 3.0;
};

struct ConcatenateOptions {
  SeamOptions seam;
  /// If there is no good seam within seam.band, the range is doubled repeatedly, up to this many
  /// seconds: recordings often begin with seconds of a T-pose.
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

  /// Searches for the seam within this many seconds only or, for `all`, everywhere, then preferring
  /// a good seam to one that keeps all of both clips; empty: no change. kUsage errors: anything
  /// else.
  [[nodiscard]] Result<void> search(std::string_view text);
};

/// How good a seam is.
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
  std::vector<std::string> faults;  ///< What is wrong with it, one phrase each; empty: it is good.
};

/// Two clips as one.
struct Concatenation : Edited {
  Seam seam;
  SeamMap map;
  double lift = 0.0;  ///< By which b was raised to stand on a's floor, metres.
  double band = 0.0;  ///< The range that was searched in the end, seconds.
  SeamCheck check;
};

/// Joins b to a where they fit best: frames of a up to the seam, then those of b, moved over the
/// ground to where a has come. The result has seam.a_frame + frames of b - seam.b_frame frames.
/// Where the floors of the clips differ, b is raised or lowered to a's floor if that improves the
/// seam (a clip cut in two on a stair stays as it was).
///
/// The seam has the least distance of Kovar, Gleicher and Pighin (2002) over windows of bone
/// positions (all bones alike), each window turned and moved over the ground as fits best. Where
/// the clips share less than a window, the distance is increased by half the missing share; it is
/// also increased where different feet are on the floor. Frames that both clips contain, at the end
/// of a and the beginning of b, are found first.
///
/// kCrossfade mixes the frames that both have from the seam on (at most the window): with k of them
/// a weighs 2 ((p + 1) / k)^3 - 3 ((p + 1) / k)^2 + 1 in the p-th; translations are mixed linearly,
/// local rotations the shorter way round. kInertial follows b from the seam on and adds to each
/// channel a cubic from the difference of values and velocities at the seam to rest; so does
/// kCrossfade where the clips share less than the window.
///
/// Where b begins one frame after a's end, as when a clip was cut in two, and no joint is too fast
/// across the cut, the two are joined as they are (seam.overlap is 0).
///
/// Feet that are in contact near the seam stay there: one that stands in both clips stays where a has
/// it until it leaves the floor. Then the seam is checked; one that is not good is a misfit.
///
/// @param b  of the same skeleton and rate as a (like_first).
/// @param a_name, b_name  for messages.
/// @return kInput errors: a clip without frames, b on another skeleton or rate; as turn_clip. kUsage
///     errors: more than 16 million pairs of frames to search.
[[nodiscard]] Result<Concatenation> concatenate(const Clip& a, const Clip& b,
                                                const Calibration& calibration,
                                                const ConcatenateOptions& options,
                                                const std::string& a_name,
                                                const std::string& b_name);

/// A clip on the skeleton and at the rate of another one, to be joined to it: transferred where the
/// skeletons or what was found of them differ. Errors as change_timing.
[[nodiscard]] Result<Edited> like_first(const Subject& next, const Subject& first);

struct LoopOptions {
  double shortest = 0.0;    ///< Of the cycle, seconds; 0: half the clip.
  ConcatenateOptions seam;  ///< How end and beginning are joined, and when the seam is good.
  bool in_place = false;    ///< The cycle neither advances nor turns.
  int times = 1;            ///< How many times the cycle is played.
};

/// A cycle without a seam.
struct Loop : Edited {  ///< `cycle` frames for each time: the frame after them would be the first
                        ///< again.
  int cycle = 0;        ///< Frames of one cycle: the source's from its first one on, but for those
                        ///< around the seam.
  double distance = 0.0;  ///< Between beginning and end before they were joined, as of a seam.
  GroundPose advance;     ///< Of one cycle over the ground, before `in_place`: of the world, as it
                          ///< turns about its origin,
  Eigen::Vector2d way = Eigen::Vector2d::Zero();  ///< and of the hips, metres: how far the body
                                                  ///< comes in a cycle.
  SeamCheck check;                                ///< Of where the end meets the beginning.
};

/// Makes a cycle from the first frame to the frame most like it, at `shortest` or later. The clip
/// is joined there to itself as by `concatenate`: frames around the seam are blended, planted feet
/// stay in place, the seam is checked. Positions and velocities of all joints are continuous from
/// each cycle to the next. If a foot is in contact throughout the cycle, the advance is chosen so that
/// it stays in place.
/// @return kInput errors: fewer than 4 frames, or than `shortest` needs; as turn_clip.
///     kUsage errors: `times` below 1, or more than 10 million frames in total.
[[nodiscard]] Result<Loop> make_loop(const Clip& clip, const Calibration& calibration,
                                     const LoopOptions& options);

// --- the way over the ground ---

struct PathFitOptions {
  double tolerance = 0.05;   ///< Largest distance of the curve from the track, metres.
  double low_pass = 0.5;     ///< Cut-off for the hips' track, Hz: removes the sway of strides.
  double still_step = 0.03;  ///< Shortest step of the track, metres.
  double first_piece = 2.0;  ///< Length of the first segments tried, metres,
  double min_piece = 0.25;   ///< and of the shortest into which they are split.
  double still_speed = 0.1;  ///< Below this speed a body has no direction of travel, m/s.
};

/// Frames [begin, end) in which the body stays in place.
struct StillPhase {
  int begin = 0, end = 0;
  double turn = 0.0;  ///< Of the hips, from the frame before to the frame after, radians.
};

/// The path of a human over the ground.
struct PathMotion {
  GroundPath path;
  std::vector<double> along;  ///< Metres along the path, per frame; never decreasing.
  std::vector<StillPhase> still;
  double largest_distance = 0.0;  ///< Of the path from the smoothed track, metres.

  /// Human-readable: length, segments, distance from the track.
  [[nodiscard]] std::string summary() const;
};

/// Fits a path to the track of the hips (Gleicher: Motion Path Editing, 2001).
///
/// The track is low-passed without delay and thinned to steps of `still_step`, so that standing
/// still adds no path. A chain of cubics by chord length, with one tangent at each joint and hence
/// without corners, is fitted to it by least squares; segments that leave the track by more than
/// the tolerance are split and all is fitted again. A body that stays within a step gets a path of
/// a millimetre in the direction it faces.
/// @return a kInput error for a clip without frames.
[[nodiscard]] Result<PathMotion> fit_path(const Clip& clip, const Calibration& calibration,
                                          const PathFitOptions& options = {});

/// The path to follow instead of a motion's own; begins where that does unless it comes from a
/// file.
struct PathChange {
  std::string to = {};   ///< `line`, `circle` or `figure8`, as long as the own; a JSON file; empty:
                         ///< the own.
  double radius = 3.0;   ///< Of a circle, metres; to the right when negative.
  double scale = 1.0;    ///< Larger or smaller, from its beginning.
  double degrees = 0.0;  ///< Turned about its beginning, to the left.

  [[nodiscard]] bool any() const { return !to.empty() || scale != 1.0 || degrees != 0.0; }
  /// kUsage errors: a radius below a centimetre.
  [[nodiscard]] Result<void> check() const;
};

/// @return kUsage errors as PathChange::check, kConfig errors of a file.
[[nodiscard]] Result<GroundPath> change_path(const GroundPath& own, const PathChange& change);

/// What stays as it is when a path becomes longer or shorter.
enum class PathKeep : std::uint8_t {
  kTime,    ///< The duration: the whole path is covered in it.
  kSpeed,   ///< The speed over the ground: a longer path takes longer.
  kStride,  ///< How far each frame is along the path: the motion ends after the length of its own
            ///< path, or goes straight on from the path's end.
};

struct FollowPathOptions {
  PathKeep keep = PathKeep::kTime;
  PathFitOptions fit;
  PlantOptions plant;
  double same_stand = 0.1;  ///< Contacts of a foot with a shorter break count as one, seconds.
  MotionLimits limits;      ///< Of the joints.
};

/// A motion on another path.
struct FollowedPath : Edited {
  PathMotion source;               ///< The motion's own path.
  std::vector<GroundPose> frames;  ///< Poses along the new path, per frame of the source.
  PlantSummary feet;
  SeamCheck check;  ///< Speeds and accelerations in the whole clip; faults where the path is too
                    ///< fast.
};

/// Sends a motion along another path: the body keeps its pose relative to the frame that moves
/// along the path (place and tangent), so the body at s(t) on its own path moves by
/// F'(s'(t)) F(s(t))^-1. Corners of a path are turned at no more than 4 rad/s. Only the channels
/// that move the whole body change; then feet that stand are planted where the frame in the middle
/// of each contact brings them.
/// @return kInput errors as fit_path and turn_clip; kUsage errors: kSpeed for a motion that stays
///     in place, or for a path more than 100 times longer or shorter.
[[nodiscard]] Result<FollowedPath> follow_path(const Clip& clip, const Calibration& calibration,
                                               const GroundPath& path,
                                               const FollowPathOptions& options);

/// A motion and the path that it follows, seen from above; either may be omitted.
struct PathDrawing {
  const Clip* clip = nullptr;
  const GroundPath* path = nullptr;
};

/// Motions of one human seen from above as SVG: the track of the hips, the path with its control
/// points, and the feet where they stand (toes where there are any, left and right in colours of
/// their own). x goes to the right, y up; a scale is drawn. The first motion is drawn paler than
/// those after it.
[[nodiscard]] std::string draw_paths(const Calibration& calibration,
                                     const std::vector<PathDrawing>& drawings);

}  // namespace retarget
