#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>

#include "retarget/human.h"

namespace retarget {

/// A body segment between two joints, or between the midpoints of two pairs of joints.
struct LimbSegment {
  const char* name;
  std::array<Bone, 2> from, to;

  [[nodiscard]] constexpr std::array<Bone, 4> bones() const {
    return {from[0], from[1], to[0], to[1]};
  }
  /// Direction of the segment; the vector is twice as long as the segment.
  /// @param place_of  returns the position of a bone's joint
  template <typename PlaceOf>
  [[nodiscard]] Eigen::Vector3d direction(const PlaceOf& place_of) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Bone bone : from) sum -= place_of(bone);
    for (const Bone bone : to) sum += place_of(bone);
    return sum;
  }
};

[[nodiscard]] constexpr LimbSegment segment_between(const char* name, Bone from, Bone to) {
  return {name, {from, from}, {to, to}};
}

/// Segments for comparing a robot's limbs with the human's.
inline constexpr std::array<LimbSegment, 11> kLimbSegments = {{
    segment_between("left thigh", Bone::kLeftUpLeg, Bone::kLeftLeg),
    segment_between("right thigh", Bone::kRightUpLeg, Bone::kRightLeg),
    segment_between("left shin", Bone::kLeftLeg, Bone::kLeftFoot),
    segment_between("right shin", Bone::kRightLeg, Bone::kRightFoot),
    segment_between("left upper arm", Bone::kLeftArm, Bone::kLeftForeArm),
    segment_between("right upper arm", Bone::kRightArm, Bone::kRightForeArm),
    segment_between("left forearm", Bone::kLeftForeArm, Bone::kLeftHand),
    segment_between("right forearm", Bone::kRightForeArm, Bone::kRightHand),
    {"trunk", {Bone::kLeftUpLeg, Bone::kRightUpLeg}, {Bone::kLeftArm, Bone::kRightArm}},
    segment_between("hip line", Bone::kRightUpLeg, Bone::kLeftUpLeg),
    segment_between("shoulder line", Bone::kRightArm, Bone::kLeftArm),
}};

/// The segments of legs and arms on one side, by the bones at their ends.
inline constexpr std::array<std::pair<LimbBone, LimbBone>, 4> kLimbParts = {
    {{LimbBone::kUpLeg, LimbBone::kLeg},
     {LimbBone::kLeg, LimbBone::kFoot},
     {LimbBone::kArm, LimbBone::kForeArm},
     {LimbBone::kForeArm, LimbBone::kHand}}};

/// A leg or an arm: the bone that it hangs on, its upper and lower bone and the joint at its end.
struct LimbBones {
  const char* name;
  Bone base, upper, lower, end;
};
inline constexpr std::array kLimbs = {
    LimbBones{"left leg", Bone::kHips, Bone::kLeftUpLeg, Bone::kLeftLeg, Bone::kLeftFoot},
    LimbBones{"right leg", Bone::kHips, Bone::kRightUpLeg, Bone::kRightLeg, Bone::kRightFoot},
    LimbBones{"left arm", Bone::kLeftShoulder, Bone::kLeftArm, Bone::kLeftForeArm, Bone::kLeftHand},
    LimbBones{"right arm", Bone::kRightShoulder, Bone::kRightArm, Bone::kRightForeArm,
              Bone::kRightHand}};

}  // namespace retarget
