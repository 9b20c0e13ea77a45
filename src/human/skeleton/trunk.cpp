#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "human/skeleton/candidate.h"
#include "human/skeleton/joint_names.h"
#include "human/skeleton/limb_segments.h"
#include "retarget/human.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using enum LimbBone;

int first_known(const BoneMap& map, std::initializer_list<Bone> bones) {
  for (const Bone bone : bones) {
    if (map.has(bone)) return map.joint(bone);
  }
  return -1;
}

// Joints strictly between two.
std::vector<int> joints_between(const BodySource& source, int a, int b) {
  if (a < 0 || b < 0 || a == b) return {};
  const std::vector<int> path = source.tree.path(a, b);
  return {path.begin() + 1, path.end() - 1};
}

void set_hips(const BodySource& source, BoneMap& map) {
  const int left = map.joint(Bone::kLeftUpLeg), right = map.joint(Bone::kRightUpLeg);
  if (left < 0 || right < 0) return;
  int above = first_known(map, {Bone::kHead, Bone::kLeftArm, Bone::kRightArm, Bone::kSpine2,
                                Bone::kSpine1, Bone::kSpine});
  if (above < 0) above = 0;
  map.joint_of_bone[Bone::kHips] = source.tree.meeting_point(left, right, above);
}

void set_torso(const BodySource& source, BoneMap& map) {
  const int hips = map.joint(Bone::kHips);
  const int left = first_known(map, {Bone::kLeftShoulder, Bone::kLeftArm});
  const int right = first_known(map, {Bone::kRightShoulder, Bone::kRightArm});
  if (map.has(Bone::kSpine2) || hips < 0 || left < 0 || right < 0) return;
  int torso = source.tree.meeting_point(left, right, hips);
  // In Biped, the arms hang from the neck; the torso is then the joint below it.
  const std::vector<int> below = joints_between(source, hips, torso);
  if (may_mean(source.names[torso], Bone::kNeck) && !below.empty()) {
    if (!map.has(Bone::kNeck)) map.joint_of_bone[Bone::kNeck] = torso;
    torso = below.back();
  }
  if (torso != hips) map.joint_of_bone[Bone::kSpine2] = torso;
}

// Spine joints below the torso. A common ancestor of hips and spine turns neither and is excluded.
std::vector<int> spine_chain(const BodySource& source, const BoneMap& map) {
  const int hips = map.joint(Bone::kHips), torso = map.joint(Bone::kSpine2);
  std::vector<int> chain = joints_between(source, hips, torso);
  if (!chain.empty()) std::erase(chain, source.tree.meeting_point(0, hips, torso));
  return chain;
}

// Maps the first joint of the spine, and of the others the one closest to halfway up to the torso.
void set_spine(const BodySource& source, BoneMap& map) {
  std::vector<int> chain = spine_chain(source, map);
  if (chain.empty()) return;
  if (!map.has(Bone::kSpine)) map.joint_of_bone[Bone::kSpine] = chain[0];
  const int first = map.joint(Bone::kSpine), torso = map.joint(Bone::kSpine2);
  std::erase_if(chain, [&](int joint) {
    return map.maps(joint) || !source.tree.between(joint, first, torso);
  });
  if (chain.empty() || map.has(Bone::kSpine1)) return;
  const double half = 0.5 * source.path_length(first, torso);
  map.joint_of_bone[Bone::kSpine1] = *std::ranges::min_element(
      chain, {}, [&](int joint) { return std::abs(source.path_length(first, joint) - half); });
}

// A neck of two joints may begin with a helper at the torso.
constexpr double kHelperLength = 1e-3;  // Share of the distance from the torso to the head.

void set_neck(const BodySource& source, BoneMap& map) {
  const int torso = map.joint(Bone::kSpine2), head = map.joint(Bone::kHead);
  if (map.has(Bone::kNeck)) return;
  const std::vector<int> chain = joints_between(source, torso, head);
  if (chain.empty()) return;
  const double min = kHelperLength * source.path_length(torso, head);
  const auto first = std::ranges::find_if(
      chain, [&](int joint) { return source.path_length(torso, joint) > min; });
  map.joint_of_bone[Bone::kNeck] = first == chain.end() ? chain[0] : *first;
}

// Lists joints inside limb segments. Their rotations appear in the bones beyond them.
void add_limb_notes(const BodySource& source, BoneMap& map) {
  std::vector<std::string> folded;
  for (const Side side : kSides) {
    for (const auto& [from, to] : kLimbParts) {
      const auto inside = source.quoted_names(
          joints_between(source, map.joint(side_bone(side, from)), map.joint(side_bone(side, to))));
      folded.insert(folded.end(), inside.begin(), inside.end());
    }
  }
  if (!folded.empty()) map.notes.push_back("folded into the limbs: " + list_names(folded));
}

}  // namespace

void complete_trunk(const BodySource& source, BoneMap& map) {
  set_hips(source, map);
  set_torso(source, map);
  set_spine(source, map);
  set_neck(source, map);
}

void add_trunk_notes(const BodySource& source, BoneMap& map) {
  std::vector<std::string> missing;
  for (const Bone bone : kMappedBones) {
    if (map.joint_of_bone[bone] < 0) missing.emplace_back(bone_name(bone));
  }
  if (!missing.empty()) map.notes.push_back("not in the source: " + list_names(missing));

  const auto add_folded = [&](Bone from, Bone to) {
    std::vector<int> folded = joints_between(source, map.joint(from), map.joint(to));
    std::erase_if(folded, [&](int joint) { return map.maps(joint); });
    if (folded.empty()) return;
    map.notes.push_back("folded into " + std::string(bone_name(to)) + ": " +
                        list_names(source.quoted_names(folded)));
  };
  add_folded(Bone::kHips, Bone::kSpine2);
  add_folded(Bone::kSpine2, Bone::kHead);
  add_limb_notes(source, map);
}

}  // namespace retarget
