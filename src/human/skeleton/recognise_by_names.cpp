#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "base/try.h"
#include "human/skeleton/candidate.h"
#include "human/skeleton/joint_names.h"
#include "retarget/human.h"

namespace retarget {
namespace {

using enum LimbBone;

// Limits the search: no body has more joints for one role.
constexpr std::size_t kMaxChoices = 8;

// If a segment is split into numbered joints in line, the upper one is the bone, and the others
// only twist. This does not hold for ambiguous words: leg1 and leg2 may be thigh and shin.
void drop_lower_parts(const BodySource& source, std::vector<NamedJoint>& found) {
  const auto is_lower_part = [&](const NamedJoint& lower) {
    const std::string_view word = without_number(source.names[lower.joint].base);
    if (meanings_of(source.names[lower.joint]).size() > 1) return false;
    return std::ranges::any_of(found, [&](const NamedJoint& upper) {
      return upper.joint != lower.joint && upper.weight == lower.weight &&
             source.names[upper.joint].base != source.names[lower.joint].base &&
             without_number(source.names[upper.joint].base) == word &&
             source.tree.between(upper.joint, 0, lower.joint);
    });
  };
  // All joints are compared with all others, so none may be removed earlier.
  std::vector<NamedJoint> upper = found;
  std::erase_if(upper, is_lower_part);
  found = std::move(upper);
}

std::vector<NamedJoint> joints_called(const BodySource& source, Bone bone) {
  std::vector<NamedJoint> found;
  for (int joint = 0; joint < source.skeleton.joint_count(); ++joint) {
    for (const auto& [meant, weight] : meanings_of(source.names[joint])) {
      if (meant == bone) found.push_back({joint, weight});
    }
  }
  drop_lower_parts(source, found);
  std::ranges::stable_sort(found, std::greater<>{}, &NamedJoint::weight);
  if (found.size() > kMaxChoices) found.resize(kMaxChoices);
  return found;
}

// A limb of one side, according to the joint names.
struct NamedLimb {
  std::vector<LimbSlot> slots;
  LimbChoice choice;
  bool whole = false;  // No required bone is missing.
};

using LimbPair = std::array<NamedLimb, 2>;  // Left, right.

// The best assignment by names alone, even if required bones are missing.
Result<LimbChoice> choose_parts(const BodySource& source, std::vector<LimbSlot> slots) {
  for (LimbSlot& slot : slots) slot.required = false;
  return choose_limb(source, slots);
}

// Whether a whole limb consists of joints that fit its upper parts better: a clavicle and an upper
// arm are not an arm. With a hand they may be, if their lengths are in proportion.
bool is_stretched(const BodySource& source, const LimbChoice& whole, const LimbChoice& parts) {
  constexpr double kBetter = 1e-9, kMinUpperPerLower = 0.6;
  if (parts.weight < whole.weight + kBetter) return false;
  const std::set<int> used(whole.joints.begin(), whole.joints.end());
  if (!std::ranges::all_of(parts.joints,
                           [&](int joint) { return joint < 0 || used.contains(joint); })) {
    return false;
  }
  if (whole.joints.back() < 0) return true;
  return source.path_length(whole.joints[1], whole.joints[2]) <
         kMinUpperPerLower * source.path_length(whole.joints[2], whole.joints[3]);
}

Result<NamedLimb> find_limb(const BodySource& source, const LimbRows& limb, Side side) {
  NamedLimb found;
  for (const auto& [part, required] : limb) {
    const Bone bone = side_bone(side, part);
    found.slots.push_back({bone, required, joints_called(source, bone)});
  }
  TRY_ASSIGN(const LimbChoice whole, choose_limb(source, found.slots));
  TRY_ASSIGN(const LimbChoice parts, choose_parts(source, found.slots));
  found.whole = !whole.joints.empty() && !is_stretched(source, whole, parts);
  found.choice = found.whole ? whole : parts;
  return found;
}

// Whether a word means one bone on the left and another bone on the right.
bool contradict(const BodySource& source, const NamedLimb& left, const NamedLimb& right) {
  for (std::size_t i = 0; i < left.choice.joints.size(); ++i) {
    for (std::size_t j = 0; j < right.choice.joints.size(); ++j) {
      const int a = left.choice.joints[i], b = right.choice.joints[j];
      if (i != j && a >= 0 && b >= 0 && source.names[a].base == source.names[b].base) return true;
    }
  }
  return false;
}

// Finds the legs or the arms. A word has one meaning on both sides, that of the side it fits
// better.
Result<LimbPair> find_limbs(const BodySource& source, const LimbRows& limb) {
  LimbPair sides;
  for (const Side side : kSides) {
    TRY_ASSIGN(sides[side == Side::kLeft ? 0 : 1], find_limb(source, limb, side));
  }
  if (!sides[0].whole || !sides[1].whole || !contradict(source, sides[0], sides[1])) return sides;
  NamedLimb& lesser = sides[sides[0].choice.weight < sides[1].choice.weight ? 0 : 1];
  TRY_ASSIGN(const LimbChoice parts, choose_parts(source, lesser.slots));
  lesser.choice = parts;
  lesser.whole = std::ranges::none_of(lesser.slots, [&](const LimbSlot& slot) {
    const auto index = static_cast<std::size_t>(&slot - lesser.slots.data());
    return slot.required && parts.joints[index] < 0;
  });
  return sides;
}

// Sets the bones of a limb. Returns the mean weight of the names of a whole limb, at most 1; else
// 0.
double map_limb(const NamedLimb& limb, BoneMap& map) {
  map.notes.insert(map.notes.end(), limb.choice.notes.begin(), limb.choice.notes.end());
  int count = 0;
  for (std::size_t i = 0; i < limb.choice.joints.size(); ++i) {
    map.joint_of_bone[limb.slots[i].bone] = limb.choice.joints[i];
    count += limb.choice.joints[i] >= 0 ? 1 : 0;
  }
  return limb.whole ? limb.choice.weight / count : 0.0;
}

// The trunk joints with the best name; of joints in line the one nearest to the root.
std::vector<int> find_named(const BodySource& source, Bone bone) {
  std::vector<NamedJoint> found = joints_called(source, bone);
  std::erase_if(found, [&](const NamedJoint& n) { return n.weight < found.front().weight; });
  std::vector<int> joints;
  for (const NamedJoint& named : found) {
    const bool is_lower = std::ranges::any_of(found, [&](const NamedJoint& upper) {
      return upper.joint != named.joint && source.tree.between(upper.joint, 0, named.joint);
    });
    if (!is_lower) joints.push_back(named.joint);
  }
  return joints;
}

// The head's joint is optional, so any of several joints is acceptable.
void set_head(const BodySource& source, BoneMap& map) {
  const std::vector<int> heads = find_named(source, Bone::kHead);
  if (heads.empty()) return;
  map.joint_of_bone[Bone::kHead] = middle_joint(source, heads);
  if (heads.size() > 1) {
    map.notes.push_back(note_of_choice(source, Bone::kHead, heads, map.joint(Bone::kHead)));
  }
}

Result<void> set_hips_by_name(const BodySource& source, BoneMap& map) {
  const std::vector<int> hips = find_named(source, Bone::kHips);
  if (hips.empty()) return {};
  if (hips.size() > 1) return ambiguous_bone(source, Bone::kHips, hips[0], hips[1]);
  map.joint_of_bone[Bone::kHips] = hips[0];
  return {};
}

// Without arms, the torso is the last spine joint before neck and head.
void set_torso_by_name(const BodySource& source, BoneMap& map) {
  if (map.has(Bone::kSpine2) || !map.has(Bone::kHips) || !map.has(Bone::kHead)) return;
  for (const int joint : source.tree.path(map.joint(Bone::kHips), map.joint(Bone::kHead))) {
    if (may_mean(source.names[joint], Bone::kSpine)) map.joint_of_bone[Bone::kSpine2] = joint;
  }
}

constexpr double kNamesConfidence = 0.9;

}  // namespace

Candidate recognise_by_names(const BodySource& source) {
  BoneMap map;
  map.profile = "names";
  set_head(source, map);

  double weight = 0.0;
  int limb_count = 0;
  TRY_ASSIGN(const LimbPair legs, find_limbs(source, kLegRows));
  TRY_ASSIGN(const LimbPair arms, find_limbs(source, kArmRows));
  for (const std::size_t side : {0, 1}) {
    for (const LimbPair* limbs : {&legs, &arms}) {
      const double limb_weight = map_limb((*limbs)[side], map);
      weight += limb_weight;
      limb_count += limb_weight > 0.0 ? 1 : 0;
    }
  }
  if (limb_count < 2) return std::nullopt;
  if (!map.has(Bone::kLeftUpLeg) || !map.has(Bone::kRightUpLeg)) {
    TRY(set_hips_by_name(source, map));
  }
  complete_trunk(source, map);
  set_torso_by_name(source, map);
  complete_trunk(source, map);
  map.confidence = kNamesConfidence * weight / limb_count;
  return map;
}

}  // namespace retarget
