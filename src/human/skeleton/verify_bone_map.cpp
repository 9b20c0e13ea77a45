#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "human/skeleton/candidate.h"
#include "human/skeleton/limb_segments.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/skeleton_tree.h"
#include "retarget/human.h"

namespace retarget {
namespace {

using enum LimbBone;

constexpr double kMinLegRatio = 0.7, kMaxLegRatio = 1.4;  // Thigh per shin.
// Differences of left and right lengths, as shares of the longer one.
constexpr double kUnequal = 0.15, kNoPair = 0.5;
// Factor of the confidence per doubt.
constexpr double kDoubt = 0.85;

void doubt(Verdict& verdict, std::string text) {
  verdict.doubts.push_back(std::move(text));
  verdict.confidence *= kDoubt;
}

void check_distinct(const BodySource& source, const BoneMap& map, Verdict& verdict) {
  std::map<int, Bone> bone_of_joint;
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint_of_bone[bone];
    if (joint < 0) continue;
    const auto [found, is_new] = bone_of_joint.try_emplace(joint, bone);
    if (is_new) continue;
    verdict.faults.push_back(fmt::format("{} would be both {} and {}", source.quoted_name(joint),
                                         bone_name(found->second), bone_name(bone)));
  }
}

void check_in_line(const BodySource& source, const BoneMap& map, Verdict& verdict) {
  for (const auto& chain : bone_chains()) {
    for (const Bone bone : bones_out_of_line(source.tree, map, chain)) {
      verdict.faults.push_back(fmt::format("{} cannot be {}: wrong position in the joint tree",
                                           source.quoted_name(map.joint(bone)), bone_name(bone)));
    }
  }
  const int left = map.joint(Bone::kLeftUpLeg), right = map.joint(Bone::kRightUpLeg);
  const int hips = map.joint(Bone::kHips);
  if (left >= 0 && right >= 0 && hips >= 0 && !source.tree.between(hips, left, right)) {
    verdict.faults.push_back(source.quoted_name(hips) + " as Hips is not between the legs");
  }
}

// Length of a limb segment; nothing if an end is missing.
std::optional<double> segment(const BodySource& source, const BoneMap& map, Side side,
                              LimbBone from, LimbBone to) {
  const int a = map.joint(side_bone(side, from)), b = map.joint(side_bone(side, to));
  if (a < 0 || b < 0) return std::nullopt;
  return source.path_length(a, b);
}

void check_legs(const BodySource& source, const BoneMap& map, Verdict& verdict) {
  for (const Side side : kSides) {
    const auto thigh = segment(source, map, side, kUpLeg, kLeg);
    const auto shin = segment(source, map, side, kLeg, kFoot);
    if (!thigh || !shin) continue;
    if (*shin <= 0.0 || *thigh < kMinLegRatio * *shin || *thigh > kMaxLegRatio * *shin) {
      verdict.faults.push_back(fmt::format("{} and {} are out of proportion",
                                           bone_name(side_bone(side, kUpLeg)),
                                           bone_name(side_bone(side, kLeg))));
    }
  }
}

void check_mirrored(const BodySource& source, const BoneMap& map, Verdict& verdict) {
  for (const auto& [from, to] : kLimbParts) {
    const auto left = segment(source, map, Side::kLeft, from, to);
    const auto right = segment(source, map, Side::kRight, from, to);
    if (!left || !right) continue;
    const double difference = std::abs(*left - *right);
    const double longer = std::max(*left, *right);
    const std::string_view what_of = bone_name(side_bone(Side::kLeft, from)).substr(4);  // UpLeg
    const std::string what = fmt::format("left and right {} differ in length", what_of);
    if (difference > kNoPair * longer) {
      verdict.faults.push_back(what);
    } else if (difference > kUnequal * longer) {
      doubt(verdict, what);
    }
  }
}

// Adds a warning unless some pose has head over torso over hips over feet, along the trunk.
void check_upright(const BodySource& source, const BoneMap& map, Verdict& verdict) {
  std::vector<int> order;
  for (const Bone bone : {Bone::kHead, Bone::kSpine2, Bone::kHips}) {
    if (map.has(bone)) order.push_back(map.joint(bone));
  }
  const int left = map.joint(Bone::kLeftFoot), right = map.joint(Bone::kRightFoot);
  if (order.size() < 2 || !map.has(Bone::kHips)) return;
  const auto is_upright = [&](const BodyPoses::Pose& pose) {
    const Eigen::Vector3d up = pose.joints[order.front()] - pose.joints[order.back()];
    const auto height = [&](int joint) { return pose.joints[joint].dot(up); };
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
      if (height(order[i]) <= height(order[i + 1])) return false;
    }
    return left < 0 || right < 0 || std::max(height(left), height(right)) < height(order.back());
  };
  if (std::ranges::any_of(source.poses.poses, is_upright)) return;
  // The zero pose of many skeletons is not a human pose.
  if (source.poses.from_motion) {
    doubt(
        verdict,
        "in no frame is the head above the torso, the torso above the hips and the hips above the "
        "feet");
  }
}

void check_sides(const BodySource& source, const BoneMap& map, Verdict& verdict) {
  if (!source.poses.from_motion) return;
  if (left_is_left(source, map) > -kMinSwapEvidence) return;
  doubt(verdict, "toes and knees point backwards: left and right may be swapped in the source");
}

bool has_all(const BoneMap& map, Side side, std::initializer_list<LimbBone> bones) {
  return std::ranges::all_of(bones, [&](LimbBone part) { return map.has(side_bone(side, part)); });
}

}  // namespace

Verdict verify_bone_map(const BodySource& source, const BoneMap& map) {
  Verdict verdict;
  check_distinct(source, map, verdict);
  check_in_line(source, map, verdict);
  if (!verdict.faults.empty()) return verdict;
  check_legs(source, map, verdict);
  check_mirrored(source, map, verdict);
  check_upright(source, map, verdict);
  check_sides(source, map, verdict);
  return verdict;
}

std::vector<std::string> missing_parts(const BoneMap& map) {
  std::vector<std::string> missing;
  if (!map.has(Bone::kHips)) missing.emplace_back("hips");
  const auto check = [&](std::initializer_list<LimbBone> bones, const std::string& limb) {
    const bool left = has_all(map, Side::kLeft, bones), right = has_all(map, Side::kRight, bones);
    if (!left && !right) {
      missing.push_back(limb + "s");
    } else if (!left || !right) {
      missing.push_back((left ? "right " : "left ") + limb);
    }
  };
  check({kUpLeg, kLeg, kFoot}, "leg");
  check({kArm, kForeArm}, "arm");
  const bool has_arms = has_all(map, Side::kLeft, {kArm}) && has_all(map, Side::kRight, {kArm});
  if (has_arms && !map.has(Bone::kSpine2)) missing.emplace_back("torso");
  return missing;
}

}  // namespace retarget
