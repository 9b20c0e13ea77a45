#include "human/skeleton/bone_map_file.h"

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "human/skeleton/candidate.h"
#include "human/skeleton/skeleton_tree.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

// Returns the joint that an entry names; -1 for null.
std::optional<int> read_joint(const std::string& bone, const Json& value, const Skeleton& skeleton,
                              Faults& faults) {
  if (value.is_null()) return -1;
  if (!value.is_string()) {
    faults.add(
        fmt::format("\"{}\" must be a joint name or null, found {}", bone, short_text(value)));
    return std::nullopt;
  }
  const std::string name = value.get<std::string>();
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
    const std::optional<Bone> bone = bone_from_name(key);
    if (!bone || limb_bone(*bone) == LimbBone::kFootMod) {
      faults.add(fmt::format("no bone \"{}\"{}", key, faults.suggestion(key, mapped_bone_names())));
      continue;
    }
    const std::optional<int> joint = read_joint(key, value, skeleton, faults);
    if (!joint || *joint < 0) continue;
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
  if (!map.has(Bone::kHips)) faults.add("\"Hips\" has no joint: without it there is no root");
  const SkeletonTree tree(skeleton);
  for (const auto& chain : bone_chains()) {
    for (const Bone bone : bones_out_of_line(tree, map, chain)) {
      faults.add(fmt::format("\"{}\" as \"{}\" is not below the bones before it",
                             skeleton.joint(map.joint(bone)).name, bone_name(bone)));
    }
  }
}

}  // namespace

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
  TRY_ASSIGN(const auto json, parse_json(text, file));
  if (!json.is_object()) {
    return config_failure(file, "a bone map must be a JSON object {bone: joint or null}");
  }
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
