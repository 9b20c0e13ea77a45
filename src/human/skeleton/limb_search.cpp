#include "human/skeleton/candidate.h"

#include <fmt/format.h>
#include <algorithm>
#include <optional>
#include <set>

#include "base/option_name.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kEqualMerit = 1e-9;

class LimbSearch {
 public:
  LimbSearch(const BodySource& source, const std::vector<LimbSlot>& slots)
      : source_(source), slots_(slots), twins_(slots.size()) {}

  Result<LimbChoice> run() {
    extend({});
    if (rival_) {
      const std::size_t slot = first_difference();
      return ambiguous_bone(source_, slots_[slot].bone, best_.joints[slot], rival_->joints[slot]);
    }
    for (std::size_t slot = 0; slot < best_.joints.size(); ++slot) settle(slot);
    return best_;
  }

 private:
  // The recursion is as deep as the limb has bones.
  void extend(const LimbChoice& begun) {
    if (begun.joints.size() == slots_.size()) {
      compare(begun);
      return;
    }
    const LimbSlot& slot = slots_[begun.joints.size()];
    for (const NamedJoint& named : slot.choices) {
      if (!fits(begun.joints, named.joint)) continue;
      LimbChoice longer = begun;
      longer.joints.push_back(named.joint);
      longer.weight += named.weight;
      extend(longer);
    }
    if (slot.required) return;
    LimbChoice without = begun;
    without.joints.push_back(-1);
    extend(without);
  }

  // Whether a joint lies beyond the chosen ones.
  bool fits(const std::vector<int>& begun, int joint) const {
    std::vector<int> chosen = begun;
    std::erase(chosen, -1);
    if (chosen.empty()) return true;
    if (std::ranges::find(chosen, joint) != chosen.end()) return false;
    return chosen.size() < 2 ||
           source_.tree.between(chosen.back(), chosen[chosen.size() - 2], joint);
  }

  void compare(const LimbChoice& choice) {
    if (best_.joints.empty() || choice.weight > best_.weight + kEqualMerit) {
      best_ = choice;
      rival_.reset();
      twins_.assign(slots_.size(), {});
      return;
    }
    if (choice.weight < best_.weight - kEqualMerit) return;
    // For equal merit, joints in line belong to one limb, and the upper one wins.
    bool in_line = true;
    int gain = 0;
    for (std::size_t i = 0; i < choice.joints.size(); ++i) {
      const int a = best_.joints[i], b = choice.joints[i];
      if (a == b) continue;
      if (a < 0 || b < 0) {
        gain += a < 0 ? 1 : -1;
        continue;
      }
      gain += preference(a, b);
      if (is_above(a, b) || is_above(b, a)) continue;
      in_line = false;
      if (slots_[i].required) rival_ = choice;
      twins_[i].insert({a, b});
    }
    if (in_line && gain > 0) best_ = choice;
  }

  // Positive if b is preferable to a: the upper joint or, if both are the same word, the shorter name,
  // because helpers have longer names.
  int preference(int a, int b) const {
    const auto length = [&](int joint) {
      return static_cast<int>(source_.skeleton.joint(joint).name.size());
    };
    const bool same_word = source_.names[a] == source_.names[b];
    if (same_word && length(a) != length(b)) return length(a) - length(b);
    return source_.tree.depth(a) - source_.tree.depth(b);
  }

  // The first required slot with different joints in best_ and rival_.
  std::size_t first_difference() const {
    std::size_t slot = 0;
    const auto& a = best_.joints;
    const auto& b = rival_->joints;
    while (slot + 1 < a.size() && (!slots_[slot].required || a[slot] == b[slot])) ++slot;
    return slot;
  }

  // Chooses among joints that fit an optional bone equally well.
  void settle(std::size_t slot) {
    int& chosen = best_.joints[slot];
    if (twins_[slot].empty() || chosen < 0) return;
    std::vector<int> joints(twins_[slot].begin(), twins_[slot].end());
    std::erase_if(joints, [&](int joint) { return !is_in_line(slot, joint); });
    if (joints.size() < 2) {
      if (!joints.empty()) chosen = joints.front();
      return;
    }
    chosen = middle_joint(source_, joints);
    best_.notes.push_back(note_of_choice(source_, slots_[slot].bone, joints, chosen));
  }

  // Whether a joint hangs between the joints of the neighbouring slots.
  bool is_in_line(std::size_t slot, int joint) const {
    int before = 0, after = joint;
    for (std::size_t i = 0; i < slot; ++i) {
      if (best_.joints[i] >= 0) before = best_.joints[i];
    }
    for (std::size_t i = slots_.size() - 1; i > slot; --i) {
      if (best_.joints[i] >= 0) after = best_.joints[i];
    }
    return source_.tree.between(joint, before, after) && source_.tree.between(before, 0, joint);
  }

  bool is_above(int a, int b) const { return source_.tree.between(a, 0, b); }

  const BodySource& source_;
  const std::vector<LimbSlot>& slots_;
  LimbChoice best_;
  std::optional<LimbChoice> rival_;   // Equal merit, but other joints in required slots.
  std::vector<std::set<int>> twins_;  // By slot: joints on separate branches that fit equally well.
};

}  // namespace

Result<LimbChoice> choose_limb(const BodySource& source, const std::vector<LimbSlot>& slots) {
  return LimbSearch(source, slots).run();
}

Failure ambiguous_bone(const BodySource& source, Bone bone, int a, int b) {
  return input_failure({},
                       fmt::format("{} and {} are equally likely to be the {}",
                                   source.quoted_name(a), source.quoted_name(b), bone_name(bone)),
                       "rename one of them, or give a bone map with " OPTION("map"));
}

std::string note_of_choice(const BodySource& source, Bone bone, const std::vector<int>& joints,
                           int chosen) {
  return fmt::format("{} could each be the {}; chose {}", list_names(source.quoted_names(joints)),
                     bone_name(bone), source.quoted_name(chosen));
}

int middle_joint(const BodySource& source, const std::vector<int>& joints) {
  const std::vector<Eigen::Vector3d>& places = source.poses.poses.front().joints;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int joint : joints) middle += places[joint] / static_cast<double>(joints.size());
  return *std::ranges::min_element(joints, [&](int a, int b) {
    const double share = 1.0 - 1e-9;  // For equal distances, the first joint wins.
    return (places[a] - middle).norm() < share * (places[b] - middle).norm();
  });
}

}  // namespace retarget
