#include "human/trunk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/suggest.h"
#include "human/body_words.h"

namespace retarget {
namespace {

bool is_mapped(const BoneMap& map, int joint) {
  return std::ranges::find(map.joint_of_bone, joint) != map.joint_of_bone.end();
}

bool has_role(const BodySource& source, int joint, Role role) {
  return std::ranges::any_of(roles_of(source.names[joint]),
                             [role](const RoleWeight& r) { return r.role == role; });
}

int first_known(const BoneMap& map, std::initializer_list<std::string_view> bones) {
  for (const std::string_view bone : bones) {
    if (map.joint(bone) >= 0) return map.joint(bone);
  }
  return -1;
}

// joints strictly between two
std::vector<int> joints_between(const BodySource& source, int a, int b) {
  if (a < 0 || b < 0 || a == b) return {};
  const std::vector<int> path = source.tree.path(a, b);
  return {path.begin() + 1, path.end() - 1};
}

double length_of_path(const BodySource& source, int a, int b) {
  const std::vector<int> path = source.tree.path(a, b);
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const bool down = source.tree.parent(path[i + 1]) == path[i];
    length += source.poses.lengths[down ? path[i + 1] : path[i]];
  }
  return length;
}

void set_hips(const BodySource& source, BoneMap& map) {
  const int left = map.joint("LeftUpLeg"), right = map.joint("RightUpLeg");
  if (left < 0 || right < 0) return;
  int above = first_known(map, {"Head", "LeftArm", "RightArm", "Spine2", "Spine1", "Spine"});
  if (above < 0) above = 0;
  joint_of(map, "Hips") = source.tree.meeting_point(left, right, above);
}

void set_torso(const BodySource& source, BoneMap& map) {
  const int hips = map.joint("Hips");
  const int left = first_known(map, {"LeftShoulder", "LeftArm"});
  const int right = first_known(map, {"RightShoulder", "RightArm"});
  if (map.joint("Spine2") >= 0 || hips < 0 || left < 0 || right < 0) return;
  int torso = source.tree.meeting_point(left, right, hips);
  // arms that hang from the neck, as in Biped: the torso is what carries the neck
  const std::vector<int> below = joints_between(source, hips, torso);
  if (has_role(source, torso, Role::kNeck) && !below.empty()) {
    if (map.joint("Neck") < 0) joint_of(map, "Neck") = torso;
    torso = below.back();
  }
  if (torso != hips) joint_of(map, "Spine2") = torso;
}

// the joints of the spine below the torso; one that carries hips and spine alike turns neither
std::vector<int> spine_chain(const BodySource& source, const BoneMap& map) {
  const int hips = map.joint("Hips"), torso = map.joint("Spine2");
  std::vector<int> chain = joints_between(source, hips, torso);
  if (!chain.empty()) std::erase(chain, source.tree.meeting_point(0, hips, torso));
  return chain;
}

// the first joint of the spine, and of the others the one nearest to halfway up to the torso
void set_spine(const BodySource& source, BoneMap& map) {
  std::vector<int> chain = spine_chain(source, map);
  if (chain.empty()) return;
  if (map.joint("Spine") < 0) joint_of(map, "Spine") = chain[0];
  const int first = map.joint("Spine"), torso = map.joint("Spine2");
  std::erase_if(chain, [&](int joint) {
    return is_mapped(map, joint) || !source.tree.between(joint, first, torso);
  });
  if (chain.empty() || map.joint("Spine1") >= 0) return;
  const double half = 0.5 * length_of_path(source, first, torso);
  joint_of(map, "Spine1") = *std::ranges::min_element(
      chain, {}, [&](int joint) { return std::abs(length_of_path(source, first, joint) - half); });
}

// necks of two joints may begin with a helper that stands at the torso
constexpr double kHelperLength = 1e-3;  // of the way from the torso to the head

void set_neck(const BodySource& source, BoneMap& map) {
  const int torso = map.joint("Spine2"), head = map.joint("Head");
  if (map.joint("Neck") >= 0) return;
  const std::vector<int> chain = joints_between(source, torso, head);
  if (chain.empty()) return;
  const double least = kHelperLength * length_of_path(source, torso, head);
  const auto first = std::ranges::find_if(
      chain, [&](int joint) { return length_of_path(source, torso, joint) > least; });
  joint_of(map, "Neck") = first == chain.end() ? chain[0] : *first;
}

// joints inside the segments of limbs: what they turn is seen in the bones beyond them
void add_limb_notes(const BodySource& source, BoneMap& map) {
  static constexpr std::array<std::pair<const char*, const char*>, 4> kSegments = {
      {{"UpLeg", "Leg"}, {"Leg", "Foot"}, {"Arm", "ForeArm"}, {"ForeArm", "Hand"}}};
  std::vector<std::string> folded;
  for (const std::string side : {"Left", "Right"}) {
    for (const auto& [from, to] : kSegments) {
      for (const int joint : joints_between(source, map.joint(side + from), map.joint(side + to))) {
        folded.push_back(quoted_name(source.skeleton, joint));
      }
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
  for (int bone = 0; bone < kMappedBoneCount; ++bone) {
    if (map.joint_of_bone[bone] < 0) missing.emplace_back(kBoneNames[bone]);
  }
  if (!missing.empty()) map.notes.push_back("not in the source: " + list_names(missing));

  const auto add_folded = [&](std::string_view from, std::string_view to) {
    std::vector<std::string> folded;
    for (const int joint : joints_between(source, map.joint(from), map.joint(to))) {
      if (!is_mapped(map, joint)) folded.push_back(quoted_name(source.skeleton, joint));
    }
    if (folded.empty()) return;
    map.notes.push_back("folded into " + std::string(to) + ": " + list_names(folded));
  };
  add_folded("Hips", "Spine2");
  add_folded("Spine2", "Head");
  add_limb_notes(source, map);
}

}  // namespace retarget
