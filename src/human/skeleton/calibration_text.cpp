#include "human/skeleton/calibration_text.h"

#include <fmt/format.h>

#include "human/skeleton/posed_body.h"
#include "human/skeleton/units.h"
#include "retarget/options.h"

namespace retarget {
namespace {

// Describes a skeleton; without a profile, by the method that found its bones.
std::string skeleton_text(const std::string& profile) {
  if (profile == "names") return "a skeleton recognised by its joint names";
  if (profile == "topology") return "a skeleton recognised by its shape";
  if (profile == "map file") return "a skeleton with a bone map from a file";
  return profile + " skeleton";
}

}  // namespace

std::string to_text(const SignedAxis& axis) {
  return std::string(axis.negative ? "-" : "+") + "xyz"[axis.axis];
}

std::string up_text(const Calibration& calibration) {
  const double tilt = tilt_degrees(calibration);
  const std::string axis = to_text(calibration.up);
  return tilt == 0.0 ? axis : fmt::format("{} levelled by {:.1f} degrees", axis, tilt);
}

std::string describe_calibration(const Calibration& calibration, const std::string& evidence) {
  const std::string height = metres_text(calibration.height), up = up_text(calibration);
  if (calibration.rest_pose.starts_with("lafan1")) {
    return fmt::format("LAFAN1 skeleton, unit {}, up {}, body height {}", calibration.unit, up,
                       height);
  }
  const std::string compared = evidence.empty() ? "" : "; " + evidence;
  const std::string rest_pose =
      calibration.rest_pose != "learned"
          ? fmt::format("from {} ({:.0f} degrees off a T-pose{})", calibration.rest_pose,
                        calibration.rest_deviation, compared)
      : evidence.empty() ? std::string("learned from the movement")
                         : fmt::format("learned from the movement ({})", evidence);
  return fmt::format("{}, unit {} ({} m), up {}, facing {}, body height {}, T-pose {}",
                     skeleton_text(calibration.profile), calibration.unit,
                     calibration.metres_per_unit, up, to_text(calibration.forward), height,
                     rest_pose);
}

}  // namespace retarget
