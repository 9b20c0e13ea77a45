#include "human/gait/limb_mover.h"

#include <cstddef>
#include <vector>

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// The axis of a knee or elbow in its joint: they bend about -z of the canonical shin or forearm.
Vector3d canonical_hinge(const Calibration& calibration, Bone middle) {
  const Vector3d axis = -Vector3d::UnitZ();
  const auto& bone_axes = calibration.bones[middle].joint_from_bone;
  return bone_axes ? *bone_axes * axis : axis;
}

}  // namespace

LimbMover::LimbMover(const Clip& clip, const Calibration& calibration, const LegJoints& joints,
                     Bone middle)
    : human_from_source_(calibration.human_from_source),
      metres_per_unit_(calibration.metres_per_unit),
      leg_(joints, learned_hinge(clip, joints, canonical_hinge(calibration, middle))) {}

void LimbMover::move_end(Clip& clip, int frame, const Quaterniond& turn,
                         const Vector3d& shift) const {
  // Shares of the leg's length. Legs may become almost straight.
  constexpr double kFree = 0.98, kFarthest = 0.999;
  std::vector<Pose> poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, frame, poses);
  const auto place = [&](int joint) -> const Vector3d& {
    return poses[static_cast<std::size_t>(joint)].translation;
  };
  const LegJoints& joints = leg_.joints();
  const Quaterniond in_source = human_from_source_.conjugate() * turn * human_from_source_;
  const Pose& ankle = poses[static_cast<std::size_t>(joints.ankle)];
  const Vector3d off = human_from_source_.conjugate() * shift / metres_per_unit_;
  const double length = (place(joints.knee) - place(joints.hip)).norm() +
                        (place(joints.ankle) - place(joints.knee)).norm();
  const double own = (place(joints.ankle) - place(joints.hip)).norm();
  leg_.reach(clip, frame, {(in_source * ankle.rotation).normalized(), ankle.translation + off},
             LegReach::of(length, own, off.norm(), kFree, kFarthest));
}

}  // namespace retarget
