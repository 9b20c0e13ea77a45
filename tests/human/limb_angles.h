#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// Mean angle in degrees, over a clip, between the direction of a limb by the positions of its ends
/// and the direction by the rotation of its bone.
struct LimbAngle {
  std::string limb;
  double mean = 0.0;
  double largest = 0.0;
};

/// Thighs, shins, upper arms, forearms: the direction to the next bone against the bone's X axis.
/// Trunk: from hips to neck against the mean of the X axes of Hips and Spine2. Hip and shoulder
/// line: from right to left against the Z axes of Hips and Spine2. Limbs without bones are omitted.
/// Swapped sides or a mirrored body give about 180 degrees in the lines.
inline std::vector<LimbAngle> limb_angles(const HumanClip& human) {
  struct Limb {
    const char* name;
    const char* from;
    const char* to;
    const char* bone;
    int axis;
  };
  constexpr std::array<Limb, 11> kLimbs = {
      {{"left thigh", "LeftUpLeg", "LeftLeg", "LeftUpLeg", 0},
       {"right thigh", "RightUpLeg", "RightLeg", "RightUpLeg", 0},
       {"left shin", "LeftLeg", "LeftFoot", "LeftLeg", 0},
       {"right shin", "RightLeg", "RightFoot", "RightLeg", 0},
       {"left upper arm", "LeftArm", "LeftForeArm", "LeftArm", 0},
       {"right upper arm", "RightArm", "RightForeArm", "RightArm", 0},
       {"left forearm", "LeftForeArm", "LeftHand", "LeftForeArm", 0},
       {"right forearm", "RightForeArm", "RightHand", "RightForeArm", 0},
       {"trunk", "Hips", "Neck", "", 0},
       {"hip line", "RightUpLeg", "LeftUpLeg", "Hips", 2},
       {"shoulder line", "RightArm", "LeftArm", "Spine2", 2}}};
  const auto bone = [](const char* name) { return bone_from_name(name).value(); };
  std::vector<LimbAngle> angles;
  for (const Limb& limb : kLimbs) {
    if (!human.has(bone(limb.from)) || !human.has(bone(limb.to))) continue;
    LimbAngle angle{limb.name};
    for (int frame = 0; frame < human.frame_count; ++frame) {
      const HumanPose& poses = human.frame(frame);
      const Eigen::Vector3d way =
          poses[bone(limb.to)].translation - poses[bone(limb.from)].translation;
      const auto axis = [&](const char* name) -> Eigen::Vector3d {
        return poses[bone(name)].rotation * Eigen::Vector3d::Unit(limb.axis);
      };
      const Eigen::Vector3d claimed =
          limb.bone[0] == '\0' ? Eigen::Vector3d(axis("Hips") + axis("Spine2")) : axis(limb.bone);
      const double degrees = std::atan2(way.cross(claimed).norm(), way.dot(claimed)) * 180.0 / M_PI;
      angle.mean += degrees / human.frame_count;
      angle.largest = std::max(angle.largest, degrees);
    }
    angles.push_back(angle);
  }
  return angles;
}

}  // namespace retarget
