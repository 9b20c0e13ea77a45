#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "human/skeleton/candidate.h"
#include "human/skeleton/joint_names.h"
#include "human/skeleton/posed_body.h"
#include "retarget/human.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using enum LimbBone;

// Thresholds for means of both sides. In humans, leg/trunk is 1.3 to 1.9, arm/leg 0.53 to 0.75,
// shoulder width/trunk 0.45 to 0.9, and foot (to the toe joints)/leg 0.14 to 0.23.
constexpr double kMinLegPerTrunk = 1.0;
constexpr double kMaxArmPerLeg = 0.8;
constexpr double kMinShouldersPerTrunk = 0.4;
constexpr double kMaxFootPerLeg = 0.35;
// Cosines of the angle between trunk and legs: standing or lying straight, trunk across the legs,
// and the minimum of a trunk that is ever raised.
constexpr double kStretched = 0.85, kAcross = 0.5, kRisen = 0.3;
constexpr double kParallel = 0.7;
// Signs that depend on poses alone. A broken or crawling human motion can show them, too.
constexpr const char* kNarrow = "the shoulders are narrow";
constexpr const char* kFourLegs = "without rotations it stands on arms and legs";
// Thresholds for chains that are not part of a human body.
constexpr std::size_t kMinTailJoints = 3;
constexpr double kMinTailPerTrunk = 0.3;
constexpr double kEqualChains = 1.15;

double mean_distance(const BodySource& source, int a, int b) {
  double sum = 0.0;
  for (const BodyPoses::Pose& pose : source.poses.poses) {
    sum += (pose.joints[a] - pose.joints[b]).norm();
  }
  return sum / static_cast<double>(source.poses.poses.size());
}

// Mean length of a limb over both sides.
double limb_length(const BodySource& source, const BoneMap& map,
                   std::initializer_list<LimbBone> parts) {
  double sum = 0.0;
  for (const Side side : kSides) {
    for (const auto* part = parts.begin(); part + 1 != parts.end(); ++part) {
      sum += 0.5 * mean_distance(source, map.joint(side_bone(side, *part)),
                                 map.joint(side_bone(side, part[1])));
    }
  }
  return sum;
}

double uprightness(const BodyPoses::Pose& pose, const BoneMap& map) {
  const auto at = [&](Bone bone) { return pose.joints[map.joint(bone)]; };
  const Eigen::Vector3d trunk = 0.5 * (at(Bone::kLeftArm) + at(Bone::kRightArm)) - at(Bone::kHips);
  const Eigen::Vector3d legs = at(Bone::kHips) - 0.5 * (at(Bone::kLeftFoot) + at(Bone::kRightFoot));
  return trunk.normalized().dot(legs.normalized());
}

double trunk_length(const BodySource& source, const BoneMap& map) {
  const int hips = map.joint(Bone::kHips);
  return 0.5 * mean_distance(source, hips, map.joint(Bone::kLeftArm)) +
         0.5 * mean_distance(source, hips, map.joint(Bone::kRightArm));
}

// Cosine between trunk and legs over a motion.
struct TrunkPosture {
  double highest = -1.0, median = -1.0;
};

TrunkPosture posture_of(const BodySource& source, const BoneMap& map) {
  std::vector<double> cosines;
  for (const BodyPoses::Pose& pose : source.poses.poses) {
    cosines.push_back(uprightness(pose, map));
  }
  return {*std::ranges::max_element(cosines), median(cosines)};
}

// Lengths of the chains below a joint that contain no mapped bone.
std::vector<double> free_chains(const BodySource& source, const BoneMap& map, int joint) {
  const TreeReach reach(source);
  std::vector<double> reaches;
  for (const int way : source.tree.neighbours(joint)) {
    const bool leads_to_bone = std::ranges::any_of(map.joint_of_bone, [&](int mapped) {
      return mapped >= 0 && mapped != joint && source.tree.between(way, joint, mapped);
    });
    if (leads_to_bone || source.tree.parent(way) != joint) continue;
    if (source.tree.chain(joint, way).size() < kMinTailJoints) continue;
    reaches.push_back(reach.reach(joint, way));
  }
  return reaches;
}

// Whether a joint has exactly one long child chain, apart from pairs such as ears. Several are
// clothes.
bool has_one_tail(const BodySource& source, const BoneMap& map, int joint, double min_length) {
  std::vector<double> reaches = free_chains(source, map, joint);
  std::erase_if(reaches, [&](double reach) { return reach < min_length; });
  std::ranges::sort(reaches);
  int tails = 0;
  for (std::size_t i = 0; i < reaches.size(); ++i) {
    if (i + 1 < reaches.size() && reaches[i + 1] <= kEqualChains * reaches[i]) {
      ++i;
    } else {
      ++tails;
    }
  }
  return tails == 1;
}

// Whether the zero pose shows an animal on four legs.
bool is_built_on_four_legs(const BodySource& source, const BoneMap& map) {
  const BodyPoses zero = sample_zero_pose(source.skeleton);
  const BodyPoses::Pose& pose = zero.poses.front();
  if (std::abs(uprightness(pose, map)) > kAcross) return false;
  return std::ranges::all_of(kSides, [&](Side side) {
    const auto along = [&](LimbBone from, LimbBone to) -> Eigen::Vector3d {
      return (pose.joints[map.joint(side_bone(side, to))] -
              pose.joints[map.joint(side_bone(side, from))])
          .normalized();
    };
    return along(kArm, kForeArm).dot(along(kUpLeg, kFoot)) > kParallel;
  });
}

// Adds signs of a four-legged animal other than a trunk across the legs.
void add_signs_of_animal(const BodySource& source, const BoneMap& map, double leg, double trunk,
                         HumanDoubts& doubts) {
  if (mean_distance(source, map.joint(Bone::kLeftArm), map.joint(Bone::kRightArm)) <
      kMinShouldersPerTrunk * trunk) {
    doubts.signs.emplace_back(kNarrow);
  }
  if (is_built_on_four_legs(source, map)) doubts.signs.emplace_back(kFourLegs);
  const bool has_toes = map.has(Bone::kLeftToe) && map.has(Bone::kRightToe);
  if (has_toes && limb_length(source, map, {kFoot, kToe}) > kMaxFootPerLeg * leg) {
    doubts.signs.emplace_back("the feet are a large part of the legs");
  }
  const int head = map.joint(Bone::kHead);
  if (head >= 0 && has_one_tail(source, map, head, kMinTailPerTrunk * trunk) &&
      has_one_tail(source, map, map.joint(Bone::kHips), kMinTailPerTrunk * trunk)) {
    doubts.signs.emplace_back("chains of joints hang from head and hips");
  }
}

}  // namespace

HumanDoubts doubt_human(const BodySource& source, const BoneMap& map) {
  HumanDoubts doubts;
  for (const Bone bone : {Bone::kHips, Bone::kLeftUpLeg, Bone::kLeftLeg, Bone::kLeftFoot,
                          Bone::kRightUpLeg, Bone::kRightLeg, Bone::kRightFoot, Bone::kLeftArm,
                          Bone::kLeftForeArm, Bone::kRightArm, Bone::kRightForeArm}) {
    if (!map.has(bone)) return doubts;
  }
  const double leg = limb_length(source, map, {kUpLeg, kLeg, kFoot});
  const double trunk = trunk_length(source, map);
  if (leg < kMinLegPerTrunk * trunk) {
    doubts.signs.emplace_back("the legs are shorter than the trunk");
  }
  const bool has_hands = map.has(Bone::kLeftHand) && map.has(Bone::kRightHand);
  if (has_hands && limb_length(source, map, {kArm, kForeArm, kHand}) > kMaxArmPerLeg * leg) {
    doubts.signs.emplace_back("the arms are as long as the legs");
  }
  const TrunkPosture posture = posture_of(source, map);
  const bool stands = source.poses.from_motion && posture.highest > kStretched;
  if (source.poses.from_motion && posture.median < kAcross) {
    doubts.signs.emplace_back(posture.highest > kRisen
                                  ? "the trunk lies across the legs most of the time"
                                  : "the trunk never rises over the legs");
    add_signs_of_animal(source, map, leg, trunk, doubts);
  }
  const auto animal = std::ranges::find_if(
      source.names, [](const JointName& name) { return is_animal_word(name.base); });
  if (animal != source.names.end()) {
    const auto joint = static_cast<int>(animal - source.names.begin());
    doubts.signs.push_back("it has a " + source.quoted_name(joint));
  }
  const auto of_poses = static_cast<std::size_t>(std::ranges::count_if(
      doubts.signs, [](const std::string& sign) { return sign == kNarrow || sign == kFourLegs; }));
  const std::size_t count = doubts.signs.size();
  doubts.proven = count >= 3 || (!stands && count - of_poses >= 2);
  return doubts;
}

}  // namespace retarget
