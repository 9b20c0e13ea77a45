#include "human/skeleton/joint_tree.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "human/skeleton/candidate.h"
#include "human/skeleton/exchanged_sides.h"
#include "human/skeleton/joint_names.h"
#include "human/skeleton/limb_segments.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using enum LimbBone;
using Eigen::Vector3d;

// Score of a required limb bone, in addition to the weight of its name.
constexpr double kNeeded = 1.0;
// Lengths break ties between names of equal weight.
constexpr double kLengthWeight = 1e-3;

// A name without its trailing number, and the number. Names that end in `end` follow all numbers.
struct NumberedName {
  std::string stem;
  int number = 0;
};
NumberedName numbered(const JointName& name) {
  constexpr std::string_view kEnd = "end";
  constexpr int kBehindAll = 1000;
  if (name.base.size() > kEnd.size() && name.base.ends_with(kEnd)) {
    return {name.base.substr(0, name.base.size() - kEnd.size()), kBehindAll};
  }
  const std::string_view stem = without_number(name.base);
  NumberedName found{std::string(stem), 0};
  std::from_chars(name.base.data() + stem.size(), name.base.data() + name.base.size(),
                  found.number);
  return found;
}

class TreeMaker {
 public:
  TreeMaker(const JointMotion& motion, const std::vector<std::string>& names)
      : words_(normalise_joint_names(names)) {
    tree_.names = names;
    for (int joint = 0; joint < motion.joint_count; ++joint) {
      auto& track = tree_.tracks.emplace_back();
      track.reserve(static_cast<std::size_t>(motion.frame_count));
      for (int frame = 0; frame < motion.frame_count; ++frame) {
        track.push_back(motion.position(frame, joint));
      }
    }
    measure_size();
  }

  std::optional<JointTree> make() {
    for (const Side side : kSides) {
      choose_limb(side, kLegRows);
      choose_limb(side, kArmRows);
    }
    const auto& bones = tree_.joint_of_bone;
    const bool legs = bones[Bone::kLeftUpLeg] >= 0 && bones[Bone::kRightUpLeg] >= 0;
    const bool arms = bones[Bone::kLeftArm] >= 0 && bones[Bone::kRightArm] >= 0;
    if (!legs && !arms) return std::nullopt;
    choose_trunk();
    if (tree_.joint_of_bone[Bone::kHips] < 0) return std::nullopt;
    connect();
    return std::move(tree_);
  }

 private:
  [[nodiscard]] int joints() const { return static_cast<int>(tree_.names.size()); }

  // Frame step that samples a few hundred frames at most.
  [[nodiscard]] int step() const { return std::max(1, tree_.frame_count() / 200); }

  [[nodiscard]] double distance(int a, int b) const {
    double sum = 0.0;
    int count = 0;
    for (int frame = 0; frame < tree_.frame_count(); frame += step(), ++count) {
      sum += (tree_.tracks[a][frame] - tree_.tracks[b][frame]).norm();
    }
    return sum / count;
  }

  void measure_size() {
    for (int joint = 1; joint < joints(); ++joint) size_ = std::max(size_, distance(0, joint));
  }

  [[nodiscard]] double weight(int joint, Bone bone) const {
    double best = 0.0;
    for (const auto& [meant, weight] : meanings_of(words_[joint])) {
      if (meant == bone) best = std::max(best, weight);
    }
    return best;
  }

  // Chooses the combination of joints whose names fit the limb best.
  void choose_limb(Side side, const LimbRows& parts) {
    std::array<std::vector<int>, 4> candidates;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      constexpr std::size_t kMost = 8;
      for (int joint = 0; joint < joints() && candidates[i].size() < kMost; ++joint) {
        if (weight(joint, side_bone(side, parts[i].bone)) > 0.0) candidates[i].push_back(joint);
      }
    }
    std::array<int, 4> chosen = {-1, -1, -1, -1}, best = chosen;
    double best_score = 0.0;
    const auto score_of = [&] {
      double score = 0.0;
      int before = -1;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        if (chosen[i] < 0) continue;
        score += weight(chosen[i], side_bone(side, parts[i].bone));
        if (parts[i].required) score += kNeeded;
        if (before >= 0 && size_ > 0.0) {
          score -= kLengthWeight * distance(before, chosen[i]) / size_;
        }
        before = chosen[i];
      }
      return score;
    };
    const auto choose = [&](auto&& self, std::size_t part) -> void {
      if (part == parts.size()) {
        const double score = score_of();
        if (score > best_score) {
          best_score = score;
          best = chosen;
        }
        return;
      }
      chosen[part] = -1;
      self(self, part + 1);
      for (const int joint : candidates[part]) {
        if (std::find(chosen.begin(), chosen.begin() + static_cast<int>(part), joint) !=
            chosen.begin() + static_cast<int>(part)) {
          continue;
        }
        chosen[part] = joint;
        self(self, part + 1);
      }
      chosen[part] = -1;
    };
    choose(choose, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      tree_.joint_of_bone[side_bone(side, parts[i].bone)] = best[i];
    }
  }

  // Joints without a side whose names mean a bone.
  [[nodiscard]] std::vector<int> middle_joints(Bone bone) const {
    std::vector<int> found;
    for (int joint = 0; joint < joints(); ++joint) {
      if (words_[joint].side == Side::kNone && weight(joint, bone) > 0.0) found.push_back(joint);
    }
    return found;
  }

  int make_middle(const std::string& name, int a, int b) {
    if (a < 0 || b < 0) return -1;
    std::vector<Vector3d> track;
    track.reserve(tree_.tracks[a].size());
    for (std::size_t i = 0; i < tree_.tracks[a].size(); ++i) {
      track.emplace_back(0.5 * (tree_.tracks[a][i] + tree_.tracks[b][i]));
    }
    tree_.tracks.push_back(std::move(track));
    tree_.names.push_back(name);
    tree_.made.push_back(name);
    words_.push_back({Side::kNone, name});
    return joints() - 1;
  }

  [[nodiscard]] int joint_called(Side side, std::string_view base) const {
    for (int joint = 0; joint < joints(); ++joint) {
      if (words_[joint].side == side && words_[joint].base == base) return joint;
    }
    return -1;
  }

  void choose_trunk() {
    auto& bones = tree_.joint_of_bone;
    std::vector<int> hips = middle_joints(Bone::kHips), spines = middle_joints(Bone::kSpine);
    std::vector<int> necks = middle_joints(Bone::kNeck), heads = middle_joints(Bone::kHead);
    const auto by_weight = [this](Bone bone) {
      return [this, bone](int a, int b) { return weight(a, bone) > weight(b, bone); };
    };
    std::ranges::stable_sort(hips, by_weight(Bone::kHips));
    std::ranges::stable_sort(heads, by_weight(Bone::kHead));
    bones[Bone::kHips] =
        !hips.empty() ? hips.front()
                      : make_middle("pelvis", bones[Bone::kLeftUpLeg], bones[Bone::kRightUpLeg]);
    if (bones[Bone::kHips] < 0) return;
    const auto from_hips = [&](int a, int b) {
      return distance(bones[Bone::kHips], a) < distance(bones[Bone::kHips], b);
    };
    std::ranges::stable_sort(spines, from_hips);
    std::ranges::stable_sort(necks, from_hips);
    if (spines.empty() && necks.empty()) {
      const int chest = make_middle("chest", bones[Bone::kLeftArm], bones[Bone::kRightArm]);
      if (chest >= 0) spines.push_back(chest);
    }
    int head = heads.empty() ? -1 : heads.front();
    if (head < 0) {
      head =
          make_middle("head", joint_called(Side::kLeft, "ear"), joint_called(Side::kRight, "ear"));
    }
    trunk_ = {bones[Bone::kHips]};
    trunk_.insert(trunk_.end(), spines.begin(), spines.end());
    torso_ = trunk_.back();
    if (spines.empty() && !necks.empty()) torso_ = necks.front();
    trunk_.insert(trunk_.end(), necks.begin(), necks.end());
    if (head >= 0) trunk_.push_back(head);
    bones[Bone::kHead] = head;
    if (torso_ != bones[Bone::kHips]) bones[Bone::kSpine2] = torso_;
    if (spines.size() > 1) bones[Bone::kSpine] = spines.front();
    if (spines.size() > 2) bones[Bone::kSpine1] = spines[(spines.size() - 1) / 2];
    if (!necks.empty() && necks.front() != torso_) bones[Bone::kNeck] = necks.front();
  }

  void connect() {
    tree_.parents.assign(tree_.names.size(), -1);
    std::vector<bool> connected(tree_.names.size(), false);
    const auto hang = [&](int joint, int parent) {
      tree_.parents[joint] = parent;
      connected[joint] = true;
    };
    hang(trunk_.front(), -1);
    for (std::size_t i = 1; i < trunk_.size(); ++i) hang(trunk_[i], trunk_[i - 1]);
    std::vector<int> body = trunk_;
    for (const Side side : kSides) {
      for (const LimbRows& limb : {kLegRows, kArmRows}) {
        int parent = limb[0].bone == kUpLeg ? trunk_.front() : torso_;
        for (const auto& [part, needed] : limb) {
          const int joint = tree_.joint_of_bone[side_bone(side, part)];
          if (joint < 0) continue;
          hang(joint, parent);
          parent = joint;
          body.push_back(joint);
        }
      }
    }
    for (int joint = 0; joint < joints(); ++joint) {
      if (!connected[joint]) tree_.parents[joint] = parent_of_other(joint, body);
    }
  }

  // Returns the joint with the next lower number, else the nearest body joint on the same side or
  // without one. A heel moves with the shin, because as the only child of an ankle it would be the
  // front of the foot.
  [[nodiscard]] int parent_of_other(int joint, const std::vector<int>& body) const {
    const Side own_side = words_[joint].side;
    if (own_side != Side::kNone && words_[joint].base == "heel") {
      const int knee = tree_.joint_of_bone[side_bone(own_side, kLeg)];
      if (knee >= 0) return knee;
    }
    const NumberedName own = numbered(words_[joint]);
    int before = -1, number = -1;
    for (int other = 0; other < joints() && own.number > 0; ++other) {
      if (other == joint || words_[other].side != words_[joint].side) continue;
      const NumberedName one = numbered(words_[other]);
      if (one.stem != own.stem || one.number >= own.number || one.number <= number) continue;
      before = other;
      number = one.number;
    }
    if (before >= 0) return before;
    int nearest = trunk_.front();
    double least = distance(joint, nearest);
    for (const int other : body) {
      const Side side = words_[other].side;
      if (side != Side::kNone && side != words_[joint].side) continue;
      const double length = distance(joint, other);
      if (length >= least) continue;
      nearest = other;
      least = length;
    }
    return nearest;
  }

  JointTree tree_;
  std::vector<JointName> words_;
  std::vector<int> trunk_;  // From the hips to the head.
  int torso_ = -1;          // Parent of the arms.
  double size_ = 0.0;       // Approximate body size.
};

// Mean and standard deviation of the distance between the joints of two bones.
struct Length {
  double mean = 0.0, deviation = 0.0;
};
std::optional<Length> length_between(const JointTree& tree, Bone from, Bone to) {
  const int a = tree.joint_of_bone[from], b = tree.joint_of_bone[to];
  if (a < 0 || b < 0) return std::nullopt;
  std::vector<double> lengths;
  lengths.reserve(tree.tracks[a].size());
  for (std::size_t i = 0; i < tree.tracks[a].size(); ++i) {
    lengths.push_back((tree.tracks[a][i] - tree.tracks[b][i]).norm());
  }
  Length found{mean(lengths), 0.0};
  for (const double length : lengths) {
    found.deviation += (length - found.mean) * (length - found.mean);
  }
  found.deviation = std::sqrt(found.deviation / static_cast<double>(lengths.size()));
  return found;
}

bool is_within(double value, double low, double high) {
  return value >= low && value <= high;
}

}  // namespace

std::optional<JointTree> joint_tree(const JointMotion& motion,
                                    const std::vector<std::string>& names) {
  return TreeMaker(motion, names).make();
}

double limb_length_change(const JointTree& tree) {
  double most = 0.0;
  for (const auto& [from, to] : kLimbParts) {
    for (const Side side : kSides) {
      const auto length = length_between(tree, side_bone(side, from), side_bone(side, to));
      if (length && length->mean > 0.0) most = std::max(most, length->deviation / length->mean);
    }
  }
  return most;
}

std::optional<double> misfit_of_body(const JointTree& tree) {
  constexpr double kMostChange = 0.2, kMostUnlike = 0.25;
  double misfit = 0.0;
  std::array<double, 4> lengths{};
  for (std::size_t i = 0; i < kLimbParts.size(); ++i) {
    const auto [from, to] = kLimbParts[i];
    const auto left =
        length_between(tree, side_bone(Side::kLeft, from), side_bone(Side::kLeft, to));
    const auto right =
        length_between(tree, side_bone(Side::kRight, from), side_bone(Side::kRight, to));
    if (!left || !right || !(left->mean > 0.0) || !(right->mean > 0.0)) return std::nullopt;
    lengths[i] = 0.5 * (left->mean + right->mean);
    const double unlike = std::abs(left->mean - right->mean) / lengths[i];
    const double change = std::max(left->deviation, right->deviation) / lengths[i];
    if (!(unlike < kMostUnlike && change < kMostChange)) return std::nullopt;
    misfit += unlike + change;
  }
  const auto& [thigh, shin, upper_arm, forearm] = lengths;
  const double leg = thigh + shin, arm = upper_arm + forearm;
  const auto hips = length_between(tree, Bone::kLeftUpLeg, Bone::kRightUpLeg);
  const auto shoulders = length_between(tree, Bone::kLeftArm, Bone::kRightArm);
  const auto trunk = length_between(tree, Bone::kHips, Bone::kSpine2);
  const bool is_body = is_within(thigh / shin, 0.65, 1.6) &&
                       is_within(upper_arm / forearm, 0.6, 1.8) && is_within(arm / leg, 0.4, 1.0) &&
                       hips && is_within(hips->mean / leg, 0.05, 0.6) && shoulders &&
                       is_within(shoulders->mean / leg, 0.2, 0.8) && trunk &&
                       is_within(trunk->mean / leg, 0.1, 1.0);
  if (!is_body || facing_by(tree, kUpLeg) < -kMinSwapEvidence) return std::nullopt;
  return misfit;
}

}  // namespace retarget
