#include "human/skeleton/stated_axes.h"

#include <fmt/format.h>

#include "base/option_name.h"
#include "human/skeleton/up_evidence.h"

namespace retarget {
namespace {

// Cosine of 60 degrees: between the tilt of a world, which a vector levels, and another axis.
constexpr double kSameAxis = 0.5;

// Whether the body clearly stands along the first axis and has no floor along the second one.
bool stands_along_one(const Body& body, const std::vector<JointPoses>& poses,
                      const SignedAxis& axis, const SignedAxis& other) {
  const FloorEvidence rival = floor_evidence(body, poses, other);
  return clearly_stands(floor_evidence(body, poses, axis), rival) && !rival.on_floor();
}

}  // namespace

std::string doubt_stated_up(const Body& body, const std::vector<JointPoses>& poses,
                            const Eigen::Vector3d& stated, const UpChoice& found) {
  if (poses.empty() || stated.normalized().dot(found.axis.direction()) >= kSameAxis) return {};
  const SignedAxis axis = nearest_axis(stated);
  if (!found.doubt.empty() && !stands_along_one(body, poses, found.axis, axis)) return {};
  return fmt::format(
      "without {}, retarget finds {} as the up axis, not {}: check it if the robot "
      "lies or is upside down",
      OPTION("up"), to_text(found.axis), to_text(axis));
}

std::string doubt_stated_forward(const Body& body, const RestCandidate& rest,
                                 const SignedAxis& stated) {
  const auto own = body_axes(body, rest.pose, rest.axes.row(2));
  if (!own || own->row(0).dot(stated.direction()) >= kSameAxis) return {};
  return fmt::format(
      "without {}, retarget finds that the rest pose faces {}, not {}: check it if "
      "the robot faces or walks the wrong way",
      OPTION("forward"), to_text(nearest_axis(own->row(0))), to_text(stated));
}

}  // namespace retarget
