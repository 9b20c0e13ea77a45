#pragma once

#include <optional>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/options.h"

namespace retarget {

struct CalibrationOptions {
  std::optional<double> metres_per_unit;  ///< Default: inferred from leg length.
  /// If no unit fits, assume an average person and warn; for callers that do not need a unit.
  bool unit_optional = false;
  /// Unit vector in the file's axes; default: an axis, inferred from the movement.
  std::optional<Eigen::Vector3d> up;
  /// Facing in the rest pose; default: inferred from hips and shoulders. Not along `up`.
  std::optional<SignedAxis> forward;
  std::optional<double> height;  ///< Body height in metres; default: estimated.
  RestPose rest = RestPose::kAuto;
  int rest_frame = 0;  ///< Frame index for RestPose::kFrame.
  /// A clip of the same skeleton (joints match by name) whose first frame is the rest pose (its
  /// zero pose if it has no frames). Requires `rest` kAuto.
  std::optional<Clip> tpose;
};

/// Calibration of LAFAN1's skeleton as in the published method: file units are centimetres, Y is
/// up, and the body height is 1.75 m, independent of the bones. The synthetic feet are at the
/// ankles and turn with the toes.
/// @param joints   joints of the bones; -1: the bone is absent
/// @param turning  joints whose rotations turn the bones
[[nodiscard]] Calibration lafan1_calibration(const BoneArray<int>& joints,
                                             const BoneArray<int>& turning);

/// Determines unit, up axis, facing, height and T-pose of a clip, and from them the calibration to
/// the canonical human. docs/human.md describes the method.
///
/// The world stays as recorded: human_from_source is the fixed rotation that maps `up` to z (a
/// quarter turn about x for y up). If `up` is not along an axis, the rotation that maps the nearest
/// axis to z is followed by the smallest rotation that maps `up` to z. The facing only affects the
/// bones' constants. A skeleton with profile `lafan1` and matching axes and unit gets
/// lafan1_calibration with its joint axes unchanged; a height in the options only replaces the 1.75
/// m.
///
/// The result depends on joint positions and rotations. It does not depend on local joint axes,
/// unit, up axis or joint order, unless the zero pose is the rest pose. The method samples ten
/// frames per second.
///
/// @return kInput errors: missing legs or arms unless the map is `partial`, unknown unit (hint:
///   `--unit`), undefined facing, T-pose file of another skeleton. kUsage errors: options out of
///   range or contradictory
[[nodiscard]] Result<Calibration> calibrate(const Clip& clip, const BoneMap& map,
                                            const CalibrationOptions& options);

}  // namespace retarget
