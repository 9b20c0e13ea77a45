#include "human/skeleton/bone_map.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "human/skeleton/candidate.h"
#include "human/skeleton/skeleton_tree.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// As a share of the longest joint offset.
constexpr double kNegligible = 1e-4;

// Follows chains of helper joints. The constructor computes the data of all joints once, so a chain
// costs one step per joint.
class HelperChain {
 public:
  HelperChain(const BoneMap& map, const Skeleton& skeleton)
      : skeleton_(skeleton),
        in_place_(map.in_place),
        children_(static_cast<std::size_t>(skeleton.joint_count())),
        carried_(children_.size()),
        bones_at_(children_.size()),
        has_extent_(children_.size()) {
    for (const int joint : map.joint_of_bone) {
      if (joint < 0) continue;
      ++bones_at_[joint];
      ++carried_[joint];
    }
    double longest = 0.0;
    // Parents precede their children, so the reverse order visits children first.
    for (int joint = skeleton.joint_count() - 1; joint >= 0; --joint) {
      const Joint& of = skeleton.joint(joint);
      if (std::ranges::any_of(of.end_sites, has_length)) has_extent_[joint] = true;
      if (of.parent < 0) continue;
      carried_[of.parent] += carried_[joint];
      children_[of.parent].push_back(joint);
      longest = std::max(longest, of.offset.norm());
      if (has_length(of.offset)) has_extent_[of.parent] = true;
    }
    min_extent_ = kNegligible * longest;
  }

  // Returns the last helper at the joint's position that rotates everything the joint rotates.
  int last_below(int joint) const {
    for (int helper = joint; helper >= 0; helper = next_below(joint)) joint = helper;
    return joint;
  }

 private:
  static bool has_length(const Eigen::Vector3d& offset) { return offset.norm() > 0.0; }

  // Returns -1 if there is none.
  int next_below(int joint) const {
    const std::vector<int>& children = children_[joint];
    const auto found = std::ranges::find_if(
        children, [&](int child) { return stands_for(child, joint); });  // The last match.
    if (found == children.end()) return -1;
    // At the end of a limb, the child replaces the joint only if the joint has no other child and
    // no end site.
    const bool is_alone = children.size() == 1 && skeleton_.joint(joint).end_sites.empty();
    return carried_[*found] > 0 || is_alone ? *found : -1;
  }

  // Returns whether a child at the joint's position rotates all bones below the joint.
  bool stands_for(int child, int joint) const {
    const Joint& candidate = skeleton_.joint(child);
    const bool is_displaced = candidate.has_position_channels()
                                  ? !std::ranges::binary_search(in_place_, child)
                                  : candidate.offset.norm() > min_extent_;
    if (is_displaced || bones_at_[child] > 0) return false;
    const int below = carried_[joint] - bones_at_[joint];
    return carried_[child] == below && (below > 0 || has_extent_[child]);
  }

  const Skeleton& skeleton_;
  const std::vector<int>& in_place_;
  std::vector<std::vector<int>> children_;  // In reverse file order.
  std::vector<int> carried_;                // Number of bones at and below a joint.
  std::vector<int> bones_at_;
  std::vector<bool> has_extent_;  // Whether a child offset or end site has a length.
  double min_extent_ = 0.0;
};

}  // namespace

bool is_above(const Skeleton& skeleton, int upper, int joint) {
  while (joint >= 0 && joint != upper) joint = skeleton.joint(joint).parent;
  return joint == upper;
}

Eigen::Vector3d farthest_end(const Joint& joint) {
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& end : joint.end_sites) {
    if (end.norm() > farthest.norm()) farthest = end;
  }
  return farthest;
}

int rotation_joint(const BoneMap& map, const Skeleton& skeleton, Bone bone) {
  const int joint = map.joint(bone);
  const int hips = map.joint(Bone::kHips);
  if (joint < 0 || hips < 0) return joint;
  // A joint above the hips rotates the part of the body on its hip side.
  if (joint != hips && is_above(skeleton, joint, hips)) {
    const int parent = skeleton.joint(joint).parent;
    return parent >= 0 ? parent : joint;
  }
  return HelperChain(map, skeleton).last_below(joint);
}

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kNoHips = "\"Hips\" has no joint, but the root requires one";

Result<Json> parse_object(std::string_view text, const std::string& file) {
  TRY_ASSIGN(auto json, parse_json(text, file));
  if (!json.is_object()) {
    return config_failure(file, "a bone map must be a JSON object {bone: joint or null}");
  }
  return json;
}

// Returns the bone that a key names.
std::optional<Bone> read_bone(const std::string& key, Faults& faults) {
  const std::optional<Bone> bone = bone_from_name(key);
  if (bone && limb_bone(*bone) != LimbBone::kFootMod) return bone;
  faults.add(fmt::format("no bone \"{}\"{}", key, faults.suggestion(key, mapped_bone_names())));
  return std::nullopt;
}

// Returns the joint name of an entry; empty for null.
std::optional<std::string> read_name(const std::string& bone, const Json& value, Faults& faults) {
  if (value.is_null()) return std::string();
  if (value.is_string()) return value.get<std::string>();
  faults.add(fmt::format("\"{}\" must be a joint name or null, found {}", bone, short_text(value)));
  return std::nullopt;
}

std::optional<int> find_joint(const std::string& bone, const std::string& name,
                              const Skeleton& skeleton, Faults& faults) {
  const std::vector<std::string> names = skeleton.names();
  const auto count = std::ranges::count(names, name);
  if (count == 1) return skeleton.find(name);
  if (count == 0) {
    faults.add(fmt::format("\"{}\": the skeleton has no joint \"{}\"{}", bone, name,
                           faults.suggestion(name, names)));
  } else {
    faults.add(fmt::format("\"{}\": {} joints are called \"{}\"; rename all but one of them", bone,
                           count, name));
  }
  return std::nullopt;
}

void read_entries(const Json& json, const Skeleton& skeleton, BoneMap& map, Faults& faults) {
  std::map<int, std::string> bone_of_joint;
  for (const auto& [key, value] : json.items()) {
    const std::optional<Bone> bone = read_bone(key, faults);
    if (!bone) continue;
    const std::optional<std::string> name = read_name(key, value, faults);
    if (!name || value.is_null()) continue;
    const std::optional<int> joint = find_joint(key, *name, skeleton, faults);
    if (!joint) continue;
    const auto [found, is_new] = bone_of_joint.try_emplace(*joint, key);
    if (!is_new) {
      faults.add(fmt::format("\"{}\" is given for two bones, \"{}\" and \"{}\"",
                             skeleton.joint(*joint).name, found->second, key));
    }
    map.joint_of_bone[*bone] = *joint;
  }
}

// Adds the faults of the map as a whole.
void check_map(const Skeleton& skeleton, const BoneMap& map, Faults& faults) {
  if (!map.has(Bone::kHips)) faults.add(kNoHips);
  const SkeletonTree tree(skeleton);
  for (const auto& chain : bone_chains()) {
    for (const Bone bone : bones_out_of_line(tree, map, chain)) {
      faults.add(fmt::format("\"{}\" as \"{}\" is not below the bones before it",
                             skeleton.joint(map.joint(bone)).name, bone_name(bone)));
    }
  }
}

}  // namespace

Result<void> check_bone_map(const std::string& path) {
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig, kMaxTextBytes));
  TRY_ASSIGN(const Json json, parse_object(text.view(), path));
  Faults faults;
  bool has_hips = false;
  for (const auto& [key, value] : json.items()) {
    const std::optional<Bone> bone = read_bone(key, faults);
    if (bone && read_name(key, value, faults) && !value.is_null() && *bone == Bone::kHips) {
      has_hips = true;
    }
  }
  if (faults.empty() && !has_hips) faults.add(kNoHips);
  return faults.empty() ? Result<void>() : faults.failure_in(path, "the bone map");
}

std::string format_bone_map(const BoneMap& map, const Skeleton& skeleton) {
  Json json = Json::object();
  for (const Bone bone : kMappedBones) {
    const int joint = map.joint_of_bone[bone];
    Json& entry = json[std::string(bone_name(bone))];
    if (joint >= 0) entry = skeleton.joint(joint).name;
  }
  // Names are raw bytes of the source file and need not be UTF-8.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<void> save_bone_map(const std::string& path, const BoneMap& map, const Skeleton& skeleton) {
  return path.empty() ? Result<void>() : write_file(path, format_bone_map(map, skeleton));
}

Result<BoneMap> parse_bone_map(std::string_view text, const std::string& file,
                               const Skeleton& skeleton) {
  TRY_ASSIGN(const Json json, parse_object(text, file));
  BoneMap map;
  map.profile = "map file";
  map.confidence = 1.0;
  Faults faults;
  read_entries(json, skeleton, map, faults);
  if (faults.empty()) check_map(skeleton, map, faults);
  if (!faults.empty()) return faults.failure_in(file, "the bone map");
  const std::vector<std::string> missing = missing_parts(map);
  map.partial = !missing.empty();
  if (map.partial) map.notes.push_back("partial: the file maps no " + list_names(missing));
  return map;
}

Result<BoneMap> read_bone_map(const std::string& path, const Skeleton& skeleton) {
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig, kMaxTextBytes));
  return parse_bone_map(text.view(), path, skeleton);
}

}  // namespace retarget
