#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "human/skeleton/candidate.h"
#include "human/skeleton/joint_names.h"
#include "human/skeleton/skeleton_profile.h"
#include "human/skeleton/skeleton_tree.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kMinScore = 0.9;
// Scores within this difference count as equal.
constexpr double kEqualScore = 0.02;
constexpr double kDirectionCosine = 0.94;  // 20 degrees

// A profile that fits, and the resulting map.
struct ProfileMatch {
  const SkeletonProfile* profile = nullptr;
  BoneMap map;
  double score = 0.0;    // 0..1
  int hints = 0;         // Marks and directions that the profile requires and the skeleton has.
  double overlap = 0.0;  // Jaccard index of all names, including fingers and ends.
};

// Share of mapped bones that lie in line.
double share_in_line(const SkeletonTree& tree, const BoneMap& map) {
  std::set<Bone> stray;
  for (const auto& chain : bone_chains()) {
    for (const Bone bone : bones_out_of_line(tree, map, chain)) stray.insert(bone);
  }
  const int mapped = map.mapped_count();
  return mapped == 0 ? 0.0 : 1.0 - static_cast<double>(stray.size()) / static_cast<double>(mapped);
}

// Names of a profile, normalised together so that they are comparable with a skeleton's.
class ProfileNames {
 public:
  explicit ProfileNames(const SkeletonProfile& profile) {
    std::set<std::string> all(profile.others.begin(), profile.others.end());
    for (const auto& spellings : profile.names) all.insert(spellings.begin(), spellings.end());
    all.insert(profile.required.begin(), profile.required.end());
    for (const auto& [joint, parent] : profile.parents) all.insert({joint, parent});
    for (const auto& [joint, direction] : profile.directions) all.insert(joint);
    written_.assign(all.begin(), all.end());
    normalised_ = normalise_joint_names(written_);
  }

  const JointName& operator[](const std::string& written) const {
    const auto found = std::ranges::lower_bound(written_, written);
    return normalised_[static_cast<std::size_t>(found - written_.begin())];
  }
  bool contains(const JointName& name) const {
    return std::ranges::find(normalised_, name) != normalised_.end();
  }

 private:
  std::vector<std::string> written_;  // Sorted.
  std::vector<JointName> normalised_;
};

// Compares a profile with a skeleton.
class Matcher {
 public:
  Matcher(const BodySource& source, const SkeletonProfile& profile, bool past_helpers)
      : source_(source), profile_(profile), names_(profile), past_helpers_(past_helpers) {}

  std::optional<ProfileMatch> run() {
    if (!has_required() || !has_mark() || !has_parents() || !has_directions()) return std::nullopt;
    ProfileMatch match;
    match.profile = &profile_;
    if (!map_bones(match.map)) return std::nullopt;
    match.map.profile = profile_.name;
    match.score = body_overlap(match.map) * share_in_line(source_.tree, match.map);
    match.hints = (profile_.marks.empty() ? 0 : 1) + (profile_.directions.empty() ? 0 : 1);
    match.overlap = full_overlap();
    match.map.confidence = match.score;
    return match;
  }

 private:
  // Joints with a name: the exact match if there is one, else all with the same normalised name.
  std::vector<int> joints_named(const std::string& written) const {
    const JointName& wanted = names_[written];
    std::vector<int> found, exact;
    for (int joint = 0; joint < source_.skeleton.joint_count(); ++joint) {
      if (source_.names[joint] != wanted) continue;
      found.push_back(joint);
      if (source_.skeleton.joint(joint).name == written) exact.push_back(joint);
    }
    return exact.size() == 1 ? exact : found;
  }

  bool has_required() const {
    return std::ranges::all_of(
        profile_.required, [&](const std::string& name) { return !joints_named(name).empty(); });
  }

  bool has_mark() const {
    if (profile_.marks.empty()) return true;
    return std::ranges::any_of(source_.skeleton.joints(), [&](const Joint& joint) {
      return std::ranges::any_of(profile_.marks, [&](const std::string& mark) {
        return joint.name.find(mark) != std::string::npos;
      });
    });
  }

  bool has_parents() const {
    return std::ranges::all_of(profile_.parents, [&](const auto& pair) {
      const std::vector<int> joints = joints_named(pair.first);
      if (joints.empty()) return true;
      const int parent = source_.tree.parent(joints[0]);
      return parent >= 0 && source_.names[parent] == names_[pair.second];
    });
  }

  bool has_directions() const {
    return std::ranges::all_of(profile_.directions, [&](const auto& pair) {
      const std::vector<int> joints = joints_named(pair.first);
      if (joints.empty()) return true;
      // A helper above the joint may coincide with it.
      int joint = joints[0];
      while (past_helpers_ && has_no_length(joint) && is_helper(source_.tree.parent(joint))) {
        joint = source_.tree.parent(joint);
      }
      const Eigen::Vector3d& offset = source_.skeleton.joint(joint).offset;
      return offset.dot(pair.second) > kDirectionCosine * offset.norm();
    });
  }

  // Returns false if two joints have a name, or if two bones claim a joint.
  bool map_bones(BoneMap& map) const {
    std::set<int> taken;
    for (const Bone bone : kMappedBones) {
      for (const std::string& spelling : profile_.names[bone]) {
        const std::vector<int> joints = joints_named(spelling);
        if (joints.empty()) continue;
        if (joints.size() > 1 || !taken.insert(joints[0]).second) return false;
        map.joint_of_bone[bone] = joints[0];
        break;
      }
    }
    return !taken.empty();
  }

  // Joints that are mapped or lie between mapped ones.
  std::set<int> body_of(const BoneMap& map) const {
    std::set<int> body;
    int first = -1;
    for (const int joint : map.joint_of_bone) {
      if (joint < 0) continue;
      if (first < 0) first = joint;
      const std::vector<int> path = source_.tree.path(first, joint);
      body.insert(path.begin(), path.end());
    }
    return body;
  }

  double body_overlap(const BoneMap& map) const {
    const std::set<int> body = body_of(map);
    int known = 0, missing = 0;
    int helpers = 0;
    for (const int joint : body) {
      known += names_.contains(source_.names[joint]) ? 1 : 0;
      helpers += past_helpers_ && is_helper(joint) ? 1 : 0;
    }
    for (const Bone bone : kMappedBones) {
      missing += !profile_.names[bone].empty() && map.joint_of_bone[bone] < 0 ? 1 : 0;
    }
    return static_cast<double>(known) / static_cast<double>(body.size() - helpers + missing);
  }

  bool has_no_length(int joint) const { return joint > 0 && source_.poses.lengths[joint] == 0.0; }

  // Whether an unknown joint coincides with its parent or one of its children.
  bool is_helper(int joint) const {
    if (joint < 0 || names_.contains(source_.names[joint])) return false;
    return has_no_length(joint) ||
           std::ranges::any_of(source_.tree.neighbours(joint), [&](int next) {
             return source_.tree.parent(next) == joint && has_no_length(next);
           });
  }

  double full_overlap() const {
    int common = 0;
    for (const JointName& name : source_.names) common += names_.contains(name) ? 1 : 0;
    int expected = static_cast<int>(profile_.others.size());
    for (const auto& spellings : profile_.names) expected += spellings.empty() ? 0 : 1;
    return static_cast<double>(common) /
           static_cast<double>(source_.skeleton.joint_count() + std::max(expected - common, 0));
  }

  const BodySource& source_;
  const SkeletonProfile& profile_;
  ProfileNames names_;
  bool past_helpers_;
};

bool is_better(const ProfileMatch& a, const ProfileMatch& b) {
  if (std::abs(a.score - b.score) > kEqualScore) return a.score > b.score;
  if (a.hints != b.hints) return a.hints > b.hints;
  if (a.overlap != b.overlap) return a.overlap > b.overlap;
  return a.profile->name < b.profile->name;
}

// Returns all profiles that fit well enough, best first.
std::vector<ProfileMatch> match_profiles(const BodySource& source,
                                         const std::vector<SkeletonProfile>& profiles) {
  std::vector<ProfileMatch> matches;
  for (const bool past_helpers : {false, true}) {
    const bool is_any = !matches.empty();
    for (const SkeletonProfile& profile : profiles) {
      // Helpers may hide the directions of a profile, whose names another profile has, too.
      const bool is_known = std::ranges::count(matches, &profile, &ProfileMatch::profile) > 0;
      if (is_any && (is_known || profile.directions.empty())) continue;
      std::optional<ProfileMatch> match = Matcher(source, profile, past_helpers).run();
      if (!match || match->score < kMinScore) continue;
      complete_trunk(source, match->map);
      matches.push_back(std::move(*match));
    }
  }
  // A selection sort: approximate equality is not transitive, so std::sort does not apply.
  for (std::size_t i = 0; i < matches.size(); ++i) {
    for (std::size_t j = i + 1; j < matches.size(); ++j) {
      if (is_better(matches[j], matches[i])) std::swap(matches[i], matches[j]);
    }
  }
  return matches;
}

}  // namespace

std::optional<BoneMap> recognise_by_profile(const BodySource& source,
                                            const std::vector<SkeletonProfile>& profiles) {
  std::vector<ProfileMatch> matches = match_profiles(source, profiles);
  if (matches.empty()) return std::nullopt;
  BoneMap map = std::move(matches[0].map);
  map.facts = matches[0].profile->facts;
  std::vector<std::string> alike;
  for (std::size_t i = 1; i < matches.size(); ++i) {
    if (matches[i].score < matches[0].score - kEqualScore) continue;
    if (matches[i].map.joint_of_bone != map.joint_of_bone) {
      if (matches[i].hints == matches[0].hints) return std::nullopt;
      continue;
    }
    // Matching directions decide for a profile against those with the same names.
    if (matches[0].profile->directions.empty()) alike.push_back(matches[i].profile->name);
  }
  if (!alike.empty()) map.notes.push_back("the same joints as in " + list_names(alike));
  return map;
}

}  // namespace retarget
