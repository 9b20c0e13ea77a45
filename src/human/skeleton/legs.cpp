#include "human/skeleton/legs.h"

namespace retarget {

bool is_at_or_below(const Skeleton& skeleton, int joint, int above) {
  while (joint > above) joint = skeleton.joint(joint).parent;
  return joint == above;
}

std::array<std::optional<LegJoints>, 2> find_legs(const Skeleton& skeleton,
                                                  const Calibration& calibration) {
  std::array<std::optional<LegJoints>, 2> legs;
  for (int foot = 0; foot < 2; ++foot) {
    const auto joint_of = [&](LimbBone part) {
      const auto& bone = calibration.bones[side_bone(kSides[foot], part)];
      // Helper joints at the same position rotate with the joint.
      return is_at_or_below(skeleton, bone.rotation_joint, bone.position_joint)
                 ? bone.position_joint
                 : -1;
    };
    const LegJoints leg{joint_of(LimbBone::kUpLeg), joint_of(LimbBone::kLeg),
                        joint_of(LimbBone::kFoot)};
    if (leg.hip >= 0 && leg.knee > leg.hip && leg.ankle > leg.knee &&
        is_at_or_below(skeleton, leg.knee, leg.hip) &&
        is_at_or_below(skeleton, leg.ankle, leg.knee)) {
      legs[foot] = leg;
    }
  }
  return legs;
}

}  // namespace retarget
