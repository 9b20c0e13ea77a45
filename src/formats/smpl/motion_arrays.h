#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/array_source.h"
#include "formats/smpl/smpl_body.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// The content of an SMPL motion file, validated and converted to one form.
struct MotionArrays {
  int frame_count = 0;
  /// Rotation vectors in rad, frame-major, kSmplJointCount per frame in the order of
  /// kSmplJointNames.
  std::vector<Eigen::Vector3d> rotations;
  /// Rotation vectors of the hand joints, kSmplHandJointCount per frame. Empty if the file has none
  /// or the hands never move.
  std::vector<Eigen::Vector3d> hand_rotations;
  std::vector<Eigen::Vector3d> translations;  ///< `trans`: one per frame, metres.
  FrameRate rate;
  std::vector<double> betas;  ///< Empty if the file has none.
  std::string gender;         ///< Empty if unknown.
  SmplFamily family = SmplFamily::kUnknown;
  std::optional<SmplRestBody> body;  ///< Body of the file itself, with its pelvis at the origin.
  std::vector<Warning> warnings;
};

/// Facts that follow from the kind of motion rather than from its arrays.
struct MotionKind {
  std::optional<double> fps;  ///< Rate for files without one, Hz.
  std::string fps_reason;     ///< Text of the warning that this rate is assumed; empty: no warning.
  std::string gender;  ///< Gender for files without one, such as `neutral`; empty if unknown.
  bool has_no_betas = false;  ///< Files of this kind never have betas, so no warning is needed.
  bool y_is_up = false;       ///< The file's world has Y up; the motion is rotated to Z up.
  /// Up axis by definition of the kind, after that rotation. Empty: inferred from the motion.
  std::optional<Eigen::Vector3d> up;
  SmplFamily family = SmplFamily::kUnknown;
  std::optional<SmplRestBody> body;
};

/// Whether the file has motion rotations under a known name.
[[nodiscard]] bool has_motion(const ArraySource& file);

/// Whether rotations and translations use AMASS's names.
[[nodiscard]] bool has_amass_names(const ArraySource& file);

/// Reads and validates the arrays of a motion.
/// @param source_fps  overrides the file's frame rate, Hz; positive and finite.
[[nodiscard]] Result<MotionArrays> read_motion_arrays(const ArraySource& file,
                                                      const MotionKind& kind,
                                                      std::optional<double> source_fps);

/// Rotation vectors that are probably in degrees.
struct DegreesFound {
  std::size_t joints = 0;  ///< That turn by more than two and a half turns.
  double value = 0.0;      ///< The largest component, of this frame and joint.
  std::size_t frame = 0;
  std::string_view joint;
};

/// Detects degrees, whose numbers may be small: of a body in radians, only the root turns
/// several times.
/// @param rotations  see MotionArrays.
[[nodiscard]] std::optional<DegreesFound> find_degrees(
    const std::vector<Eigen::Vector3d>& rotations);

/// A unit of `trans` other than metres.
struct TranslationUnit {
  double metres = 1.0;
  std::string reason;  ///< A sentence for the user.
};

/// Detects from statistics of the whole clip that `trans` is in centimetres or millimetres. The
/// body is in metres, and one of its feet is nearly always at rest. Another unit is evident if, in
/// metres, the slower foot exceeds human speed in half of the frames but not in the other unit; or
/// if, in metres, the lowest foot is ten metres or more away from height 0 but near 0 in the other
/// unit.
/// @return nothing for metres, or if no other unit explains the data better.
[[nodiscard]] std::optional<TranslationUnit> find_translation_unit(const MotionArrays& arrays,
                                                                   const SmplRestBody& body);

/// The frame rate that a file states.
struct MotionRate {
  std::optional<FrameRate> rate;  ///< Empty: the file states none.
  std::vector<Warning> warnings;  ///< About times per frame that contradict it.
};

/// Reads the frame rate of a motion file from any of its known names: `fps`, `mocap_framerate` and
/// similar ones, otherwise `dt` and similar ones. Numbers that differ only by their rounding state
/// one rate. Errors: two different rates, an invalid rate.
/// @param source_fps  overrides the file's rate, Hz; positive and finite.
[[nodiscard]] Result<MotionRate> read_motion_rate(const ArraySource& file,
                                                  std::optional<double> source_fps);

/// The error for a file without a rate whose kind has no usual one.
[[nodiscard]] Failure no_motion_rate(const ArraySource& file);

/// A warning about the gaps in the numbers of video frames that fits to video state as `frame_ids`;
/// nothing without gaps.
[[nodiscard]] std::optional<std::string> missing_frames(const ArraySource& file, int frame_count,
                                                        const FrameRate& rate);

/// Kind of data in a motion file.
enum class MotionContent : std::uint8_t {
  kSmpl,    ///< Rotations of SMPL's joints. Also used for unknown content, which the SMPL reader
            ///< reports.
  kJoints,  ///< Joint positions: read_joint_motion.
};

/// An opened motion file: its arrays and the facts that follow from its kind.
struct MotionFile {
  std::unique_ptr<ArraySource> arrays;
  MotionKind kind;
  std::vector<Warning> warnings;
  MotionContent content = MotionContent::kSmpl;
  bool took = false;  ///< The motion is one of several, selected by ArrayReadOptions::take.
};

struct ArrayReadOptions {
  /// Frame rate in Hz that overrides the file's, which may then be missing or wrong.
  std::optional<double> source_fps;
  /// Limit in bytes on the memory of the clip, and of an array after conversion to double.
  std::size_t max_clip_bytes = std::numeric_limits<std::size_t>::max();
  /// The user's body model; nullptr: the generic body. Must outlive the call.
  const SmplBody* body = nullptr;
  std::string take;  ///< One of several motions, by name or number from 1; empty: the only one.
  /// Joint names for position data, also in a 2-D table; empty: as in the file.
  std::vector<std::string> joint_names;
};

/// Opens a file and detects its type by content: NPZ; PyTorch archives (GVHMR results, InterMimic
/// tensors, dictionaries with the arrays of an NPZ); pickles of such dictionaries, also as written
/// by numpy.save; single NumPy arrays (Motion-X, PHUMA, joint positions).
///
/// Errors: those of the file readers, and one-sentence errors for content that is not a human
/// motion.
/// @param bytes  the whole file; must outlive the result.
[[nodiscard]] Result<MotionFile> open_motion_file(std::string_view bytes,
                                                  const std::string& file_name,
                                                  const ArrayReadOptions& options = {});

/// open_motion_file for a single NumPy array. @param bytes  begin with NumPy's magic number
[[nodiscard]] Result<MotionFile> open_array_motion(std::string_view bytes,
                                                   const std::string& file_name,
                                                   const ArrayReadOptions& options);

/// open_motion_file for a pickle. @param bytes  begin like a pickle
[[nodiscard]] Result<MotionFile> open_pickled_motion(std::string_view bytes,
                                                     const std::string& file_name,
                                                     const ArrayReadOptions& options);

/// Number of columns of InterMimic's motions.
inline constexpr std::size_t kInterMimicColumns = 591;

/// A motion in the column layout of InterMimic's and holosoma's loaders (OMOMO among the data).
/// Columns 0 to 2: pelvis position in metres, Z up. 3 to 6: pelvis rotation, quaternion x y z w. 9
/// to 161: rotation vectors of 51 joints in MuJoCo's order (depth first), in axes with x forward, y
/// left, z up. 162 to 317: positions of all 52 bodies. The remaining columns (object, contacts) are
/// not read.
struct InterMimicMotion {
  std::unique_ptr<ArraySource> arrays;  ///< `poses` (F, 66) and `trans` (F, 3) in SMPL's
                                        ///< convention.
  MotionKind kind;  ///< 30 fps; its body has the bone lengths given by the positions.
};

/// Converts a table of shape (F, 591).
/// Errors: no frames, numbers that are not finite, or rotations and positions that disagree by more
/// than a centimetre, which means that the columns hold other data.
[[nodiscard]] Result<InterMimicMotion> read_intermimic(const NpyArray& table,
                                                       const std::string& file_name);

}  // namespace retarget
