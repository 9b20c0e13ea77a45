#pragma once

#include <optional>

#include "human/bone_map.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/options.h"

namespace retarget {

struct CalibrationOptions {
  std::optional<double> metres_per_unit;  ///< Found from the leg's length without.
  bool unit_optional = false;             ///< Where no unit fits, take one in which the body is an
                                          ///< average person's, with a doubt; for what needs none.
  std::optional<SignedAxis> up;           ///< Found from the movement without.
  std::optional<SignedAxis> forward;      ///< Facing in the rest pose; found from hips and
                                          ///< shoulders without. Must not be along `up`.
  std::optional<double> height;           ///< Of the body in metres; estimated without.
  RestPose rest = RestPose::kAuto;
  int rest_frame = 0;         ///< For RestPose::kFrame.
  std::optional<Clip> tpose;  ///< A clip of the same skeleton (joints found by name) whose first
                              ///< frame is the rest pose (its zero pose if it has no frames);
                              ///< `rest` must be kAuto then.
};

/// Finds units, up axis, facing, height and T-pose of a clip and makes the calibration to the
/// canonical human; see docs/human.md for the method.
///
/// The world stays as recorded: human_from_source is the fixed rotation that takes `up` to z (the
/// quarter turn about x for y up); facing enters the bones' constants alone. A skeleton whose
/// profile is `lafan1` and whose axes and unit agree gets lafan1_calibration, joint axes as they are
/// (so does a body height given in the options, which replaces the 1.75 m).
///
/// The result depends on joint positions and on how joints turn, not on the choice of the joints'
/// local axes, of unit, up axis or joint order, except through the zero pose where that is taken.
/// Frames are looked at ten times a second.
///
/// @return kInput errors: legs or arms missing when the map is not `partial`, a unit that cannot
///     be told (hint: `--unit`), no facing, a T-pose file of another skeleton; kUsage errors:
///     options out of range or contradicting.
[[nodiscard]] Result<Calibration> calibrate(const Clip& clip, const BoneMap& map,
                                            const CalibrationOptions& options);

}  // namespace retarget
