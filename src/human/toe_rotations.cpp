#include "human/toe_rotations.h"

#include "human/canonical_pose.h"

namespace retarget {
namespace {

// by how much the trace of a rotation tells its angle: 1 + 2 cos
constexpr double kTraceOfRightAngle = 1.0;
constexpr double kShareOfFrames = 0.01;

}  // namespace

std::vector<Side> sides_with_flipped_toes(const Body& body, const std::vector<JointPoses>& poses,
                                          const JointFromBone& axes) {
  std::vector<Side> sides;
  for (const Side side : kSides) {
    const Bone foot_bone = side_bone(side, LimbBone::kFoot);
    const Bone toe_bone = side_bone(side, LimbBone::kToe);
    const int foot = body.turning_joint(foot_bone), toe = body.turning_joint(toe_bone);
    const auto& foot_axes = axes[foot_bone];
    const auto& toe_axes = axes[toe_bone];
    if (foot < 0 || toe < 0 || !foot_axes || !toe_axes) continue;
    const Eigen::Matrix3d foot_from_toe_in_t =
        canonical_t_pose(foot_bone).transpose() * canonical_t_pose(toe_bone);
    std::size_t flipped = 0;
    for (const JointPoses& pose : poses) {
      const Eigen::Matrix3d world_from_foot = pose[foot].rotation.toRotationMatrix() * *foot_axes;
      const Eigen::Matrix3d world_from_toe = pose[toe].rotation.toRotationMatrix() * *toe_axes;
      const Eigen::Matrix3d turn =
          (world_from_foot * foot_from_toe_in_t).transpose() * world_from_toe;
      flipped += turn.trace() < kTraceOfRightAngle ? 1 : 0;
    }
    if (static_cast<double>(flipped) > kShareOfFrames * static_cast<double>(poses.size())) {
      sides.push_back(side);
    }
  }
  return sides;
}

}  // namespace retarget
