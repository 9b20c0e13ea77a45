#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/edit_paths.h"
#include "retarget/edit_seams.h"
#include "retarget/edited.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/scene.h"

// Edits of clips, as in `retarget edit` (docs/editing.md) and with the same defaults. The edits of
// time, skeleton and place are here; edit_seams.h and edit_paths.h have the others.
//
// Most edits work on the human in a clip and take its calibration, computed from the whole clip.
// Errors about a single clip name no file because the caller knows it.

namespace RETARGET_API retarget {

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
/// @param plane  the mirror_plane() of the clip as it was read, because cleaning may move the first
///               frame.
[[nodiscard]] Result<MirroredHuman> mirror_human(const Clip& clip, const Calibration& calibration,
                                                 const MirrorPlane& plane);

/// The plane of mirror(): vertical, through the hips of the first frame along their heading.
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

}  // namespace retarget
