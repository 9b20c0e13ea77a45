#include "human/recognise_by_names.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "human/body_words.h"
#include "human/trunk.h"

namespace retarget {
namespace {

struct Named {
  int joint;
  double weight;
};

// one bone of a limb: what may stand for it
struct Slot {
  std::string bone;
  bool required;
  std::vector<Named> choices;
};

// more joints of one role are no body's; keeps the search small
constexpr std::size_t kMostChoices = 8;

std::vector<Named> joints_of_role(const BodySource& source, Role role, Side side) {
  std::vector<Named> found;
  for (int joint = 0; joint < source.skeleton.joint_count(); ++joint) {
    if (source.names[joint].side != side) continue;
    for (const RoleWeight& r : roles_of(source.names[joint])) {
      if (r.role == role) found.push_back({joint, r.weight});
    }
  }
  std::ranges::stable_sort(found, std::greater<>{}, &Named::weight);
  if (found.size() > kMostChoices) found.resize(kMostChoices);
  return found;
}

// a way to fill the slots: a joint each, or -1
struct Choice {
  std::vector<int> joints;
  double weight = 0.0;
};

constexpr double kEqualMerit = 1e-9;

// finds the best way to fill the slots of a limb with joints in line
class LimbSearch {
 public:
  LimbSearch(const BodySource& source, const std::vector<Slot>& slots)
      : source_(source), slots_(slots) {}

  Result<Choice> run() {
    extend({});
    if (rival_) {
      const std::size_t slot = first_difference();
      return input_failure(source_.file,
                           quoted_name(source_.skeleton, best_.joints[slot]) + " and " +
                               quoted_name(source_.skeleton, rival_->joints[slot]) +
                               " may both be the " + slots_[slot].bone +
                               ": which of them it is cannot be told",
                           "rename one of them, or give a mapping file with --map");
    }
    return best_;
  }

 private:
  // recurses as deep as a limb has bones
  void extend(const Choice& begun) {
    if (begun.joints.size() == slots_.size()) {
      compare(begun);
      return;
    }
    const Slot& slot = slots_[begun.joints.size()];
    for (const Named& named : slot.choices) {
      if (!fits(begun, named.joint)) continue;
      Choice longer = begun;
      longer.joints.push_back(named.joint);
      longer.weight += named.weight;
      extend(longer);
    }
    if (slot.required) return;
    Choice without = begun;
    without.joints.push_back(-1);
    extend(without);
  }

  // whether a joint lies beyond those chosen
  bool fits(const Choice& begun, int joint) const {
    std::vector<int> chosen;
    std::ranges::copy_if(begun.joints, std::back_inserter(chosen), [](int j) { return j >= 0; });
    if (chosen.empty()) return true;
    if (std::ranges::find(chosen, joint) != chosen.end()) return false;
    return chosen.size() < 2 ||
           source_.tree.between(chosen.back(), chosen[chosen.size() - 2], joint);
  }

  void compare(const Choice& choice) {
    if (best_.joints.empty() || choice.weight > best_.weight + kEqualMerit) {
      best_ = choice;
      rival_.reset();
      return;
    }
    if (choice.weight < best_.weight - kEqualMerit) return;
    // equal merit: joints in line are parts of one limb, the upper one counts
    bool in_line = true;
    int gain = 0;
    for (std::size_t i = 0; i < choice.joints.size(); ++i) {
      const int a = best_.joints[i], b = choice.joints[i];
      if (a == b) continue;
      if (a < 0 || b < 0) {
        gain += a < 0 ? 1 : -1;
        continue;
      }
      in_line = in_line && (is_above(a, b) || is_above(b, a));
      gain += preference(a, b);
    }
    if (!in_line) {
      rival_ = choice;
    } else if (gain > 0) {
      best_ = choice;
    }
  }

  // positive if b is to be preferred to a: the upper one, but of one word the shorter name, which is
  // no helper's
  int preference(int a, int b) const {
    const auto length = [&](int joint) {
      return static_cast<int>(source_.skeleton.joint(joint).name.size());
    };
    const bool same_word = source_.names[a] == source_.names[b];
    if (same_word && length(a) != length(b)) return length(a) - length(b);
    return source_.tree.depth(a) - source_.tree.depth(b);
  }

  // the first slot that best and rival fill with different joints
  std::size_t first_difference() const {
    std::size_t slot = 0;
    const auto& a = best_.joints;
    const auto& b = rival_->joints;
    while (a[slot] < 0 || b[slot] < 0 || a[slot] == b[slot]) ++slot;
    return slot;
  }

  bool is_above(int a, int b) const { return source_.tree.between(a, 0, b); }

  const BodySource& source_;
  const std::vector<Slot>& slots_;
  Choice best_;
  std::optional<Choice> rival_;
};

struct LimbBone {
  std::string_view bone;
  Role role;
  bool required;
};
constexpr std::array<LimbBone, 4> kLeg = {{{"UpLeg", Role::kThigh, true},
                                           {"Leg", Role::kShin, true},
                                           {"Foot", Role::kFoot, true},
                                           {"Toe", Role::kToe, false}}};
constexpr std::array<LimbBone, 4> kArm = {{{"Shoulder", Role::kClavicle, false},
                                           {"Arm", Role::kUpperArm, true},
                                           {"ForeArm", Role::kForearm, true},
                                           {"Hand", Role::kHand, false}}};

// sets the bones of a limb where they are found; the weight of the names, at most 1
Result<double> map_limb(const BodySource& source, const std::array<LimbBone, 4>& limb, Side side,
                        BoneMap& map) {
  const std::string side_name = side == Side::kLeft ? "Left" : "Right";
  std::vector<Slot> slots;
  slots.reserve(limb.size());
  for (const LimbBone& bone : limb) {
    slots.push_back({side_name + std::string(bone.bone), bone.required,
                     joints_of_role(source, bone.role, side)});
  }
  const Result<Choice> choice = LimbSearch(source, slots).run();
  if (!choice) return failure(choice.error());
  int count = 0;
  for (std::size_t i = 0; i < choice->joints.size(); ++i) {
    joint_of(map, slots[i].bone) = choice->joints[i];
    count += choice->joints[i] >= 0 ? 1 : 0;
  }
  return count == 0 ? 0.0 : choice->weight / count;
}

// the best named joint of the trunk; of equals the one nearest to the root
Result<int> find_named(const BodySource& source, Role role, const std::string& bone) {
  std::vector<Named> found = joints_of_role(source, role, Side::kNone);
  if (found.empty()) return -1;
  std::erase_if(found, [&](const Named& n) { return n.weight < found.front().weight; });
  const auto upper = std::ranges::min_element(
      found, {}, [&](const Named& n) { return source.tree.depth(n.joint); });
  for (const Named& other : found) {
    if (source.tree.between(upper->joint, 0, other.joint)) continue;
    return input_failure(source.file,
                         quoted_name(source.skeleton, upper->joint) + " and " +
                             quoted_name(source.skeleton, other.joint) + " may both be the " +
                             bone + ": which of them it is cannot be told",
                         "rename one of them, or give a mapping file with --map");
  }
  return upper->joint;
}

// without arms the torso is the last joint of the spine before neck and head
void set_torso_by_name(const BodySource& source, BoneMap& map) {
  if (map.joint("Spine2") >= 0 || map.joint("Hips") < 0 || map.joint("Head") < 0) return;
  for (const int joint : source.tree.path(map.joint("Hips"), map.joint("Head"))) {
    const std::vector<RoleWeight> roles = roles_of(source.names[joint]);
    if (!roles.empty() && roles[0].role == Role::kSpine) joint_of(map, "Spine2") = joint;
  }
}

constexpr double kNamesConfidence = 0.9;

}  // namespace

Candidate recognise_by_names(const BodySource& source) {
  BoneMap map;
  map.dialect = "names";
  const Result<int> head = find_named(source, Role::kHead, "Head");
  if (!head) return failure(head.error());
  joint_of(map, "Head") = *head;

  double weight = 0.0;
  int limb_count = 0;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    for (const auto* limb : {&kLeg, &kArm}) {
      const Result<double> limb_weight = map_limb(source, *limb, side, map);
      if (!limb_weight) return failure(limb_weight.error());
      weight += *limb_weight;
      limb_count += *limb_weight > 0.0 ? 1 : 0;
    }
  }
  if (limb_count < 2) return std::nullopt;
  if (map.joint("LeftUpLeg") < 0 || map.joint("RightUpLeg") < 0) {
    const Result<int> hips = find_named(source, Role::kHips, "Hips");
    if (!hips) return failure(hips.error());
    joint_of(map, "Hips") = *hips;
  }
  complete_trunk(source, map);
  set_torso_by_name(source, map);
  complete_trunk(source, map);
  map.confidence = kNamesConfidence * weight / limb_count;
  return map;
}

}  // namespace retarget
