#include "live/stream/clip_axes.h"

#include <utility>

#include "retarget/plan.h"
#include "retarget/try.h"

namespace retarget {

Result<Clip> clip_with_units(Clip clip, const HumanOptions& options,
                             const std::string& data_folder) {
  ClipOrigin origin = clip.origin();
  if (origin.metres_per_unit && origin.up) return clip;
  // find_human may replace rotations, but the clip is played unchanged.
  Clip looked_at = clip;
  RETARGET_TRY_ASSIGN(const HumanInClip found, find_human(looked_at, options, data_folder));
  if (!origin.metres_per_unit) origin.metres_per_unit = found.calibration.metres_per_unit;
  if (!origin.up) {
    origin.up = found.calibration.human_from_source.transpose() * Eigen::Vector3d::UnitZ();
  }
  clip.set_origin(std::move(origin));
  return clip;
}

ClipAxes::ClipAxes(const Clip& clip, const Eigen::Vector3d& up) {
  const ClipOrigin& origin = clip.origin();
  if (origin.up) turn_ = Eigen::Quaterniond::FromTwoVectors(*origin.up, up);
  metres_per_unit_ = origin.metres_per_unit.value_or(1.0);
}

}  // namespace retarget
