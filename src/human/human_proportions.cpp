#include "human/human_proportions.h"

#include <algorithm>

#include "human/body_words.h"

namespace retarget {
namespace {

// means of both sides; adults have legs of 1.3 to 1.7 trunks and arms of 0.6 to 0.75 legs
constexpr double kLeastLegPerTrunk = 1.0;
constexpr double kMostArmPerLeg = 0.9;
// cosine of the angle between trunk and legs in the straightest pose
constexpr double kLeastUprightness = 0.3;

double mean_distance(const BodySource& source, int a, int b) {
  double sum = 0.0;
  for (const BodyPoses::Pose& pose : source.poses.poses) {
    sum += (pose.joints[a] - pose.joints[b]).norm();
  }
  return sum / static_cast<double>(source.poses.poses.size());
}

// sum of the mean lengths of both sides' segments, halved
double limb_length(const BodySource& source, const BoneMap& map,
                   std::initializer_list<const char*> bones) {
  double sum = 0.0;
  for (const std::string side : {"Left", "Right"}) {
    for (auto bone = bones.begin(); bone + 1 != bones.end(); ++bone) {
      sum += 0.5 * mean_distance(source, map.joint(side + *bone), map.joint(side + bone[1]));
    }
  }
  return sum;
}

double uprightness(const BodyPoses::Pose& pose, const BoneMap& map) {
  const auto at = [&](const char* bone) { return pose.joints[map.joint(bone)]; };
  const Eigen::Vector3d trunk = 0.5 * (at("LeftArm") + at("RightArm")) - at("Hips");
  const Eigen::Vector3d legs = at("Hips") - 0.5 * (at("LeftFoot") + at("RightFoot"));
  return trunk.normalized().dot(legs.normalized());
}

double trunk_length(const BodySource& source, const BoneMap& map) {
  double sum = 0.0;
  for (const char* arm : {"LeftArm", "RightArm"}) {
    const int joint = map.joint(arm);
    sum += 0.5 * mean_distance(source, map.joint("Hips"), joint);
  }
  return sum;
}

}  // namespace

HumanDoubts doubt_human(const BodySource& source, const BoneMap& map) {
  HumanDoubts doubts;
  for (const char* bone : {"Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "RightUpLeg", "RightLeg",
                           "RightFoot", "LeftArm", "LeftForeArm", "RightArm", "RightForeArm"}) {
    if (map.joint(bone) < 0) return doubts;
  }
  const double leg = limb_length(source, map, {"UpLeg", "Leg", "Foot"});
  if (leg < kLeastLegPerTrunk * trunk_length(source, map)) {
    doubts.signs.emplace_back("the legs are shorter than the trunk");
  }
  const bool has_hands = map.joint("LeftHand") >= 0 && map.joint("RightHand") >= 0;
  if (has_hands && limb_length(source, map, {"Arm", "ForeArm", "Hand"}) > kMostArmPerLeg * leg) {
    doubts.signs.emplace_back("the arms are as long as the legs");
  }
  const bool stands = source.poses.from_motion &&
                      std::ranges::any_of(source.poses.poses, [&](const BodyPoses::Pose& pose) {
                        return uprightness(pose, map) > kLeastUprightness;
                      });
  if (source.poses.from_motion && !stands) {
    doubts.signs.emplace_back("the trunk never rises over the legs");
  }
  for (int joint = 0; joint < source.skeleton.joint_count(); ++joint) {
    if (!is_animal_word(source.names[joint].base)) continue;
    doubts.signs.push_back("it has a " + quoted_name(source.skeleton, joint));
    break;
  }
  doubts.proven = doubts.signs.size() >= (stands ? 3U : 2U);
  return doubts;
}

}  // namespace retarget
