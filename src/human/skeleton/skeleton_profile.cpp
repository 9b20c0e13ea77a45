#include "human/skeleton/skeleton_profile.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/options.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kKeys = {"description",     "joints",  "others",     "required",
                                        "marks",           "parents", "directions", "height_m",
                                        "metres_per_unit", "up",      "rest_pose"};

std::string in_quotes(const std::string& text) {
  return "\"" + text + "\"";
}

// Reads a profile member by member and collects its faults.
class SkeletonProfileReader {
 public:
  SkeletonProfileReader(const Json& json, Faults& faults)
      : members_(json, faults), faults_(faults) {}

  SkeletonProfile read(const std::string& name) {
    members_.check_keys(kKeys);
    profile_.name = name;
    profile_.description = members_.text("description");
    read_joints();
    profile_.others = texts("others");
    profile_.required = texts("required");
    profile_.marks = texts("marks");
    read_parents();
    read_directions();
    profile_.facts.height = positive("height_m");
    profile_.facts.metres_per_unit = positive("metres_per_unit");
    if (const Json* up = members_.find("up")) profile_.facts.up = direction(*up, "\"up\"");
    read_rest_pose();
    return std::move(profile_);
  }

 private:
  // Reads a string or a list of strings.
  std::vector<std::string> texts(const Json& value, const std::string& what) {
    std::vector<std::string> result;
    const auto is_text = [](const Json& v) {
      return v.is_string() && !v.get_ref<const std::string&>().empty();
    };
    if (is_text(value)) return {value.get<std::string>()};
    if (!value.is_array() || !std::ranges::all_of(value, is_text)) {
      faults_.add(what + " must be a string or a list of strings, found " + short_text(value));
      return {};
    }
    for (const Json& entry : value) result.push_back(entry.get<std::string>());
    return result;
  }
  std::vector<std::string> texts(const std::string& key) {
    const Json* value = members_.find(key);
    return value == nullptr ? std::vector<std::string>() : texts(*value, in_quotes(key));
  }

  std::optional<double> positive(const std::string& key) {
    const Json* value = members_.find(key);
    if (value == nullptr) return std::nullopt;
    if (value->is_number() && value->get<double>() > 0.0) return value->get<double>();
    faults_.add(in_quotes(key) + " must be a number greater than 0, found " + short_text(*value));
    return std::nullopt;
  }

  std::optional<Eigen::Vector3d> direction(const Json& value, const std::string& what) {
    const auto vector = vector_from(value);
    if (vector && vector->norm() > 0.0 && std::isfinite(vector->norm())) {
      return vector->normalized();
    }
    faults_.add(what + " must be a direction [x, y, z], found " + short_text(value));
    return std::nullopt;
  }

  void read_rest_pose() {
    // A canonical rest pose (LAFAN1's) already has the bone axes, so nothing needs to be found.
    static const std::vector<std::string> kRestPoses = {"canonical", "zero", "first"};
    const std::string name = members_.text("rest_pose");
    if (name == "zero") profile_.facts.rest = RestPose::kZero;
    if (name == "first") profile_.facts.rest = RestPose::kFirst;
    if (name.empty() || std::ranges::find(kRestPoses, name) != kRestPoses.end()) return;
    faults_.add("\"rest_pose\" is one of " + list_names(kRestPoses) + ", found " + in_quotes(name) +
                did_you_mean(name, kRestPoses));
  }

  void read_joints() {
    if (members_.find("joints") == nullptr) faults_.add("\"joints\" is missing");
    for (const auto& [bone, value] : members_.object("joints").items()) {
      const auto& known = mapped_bone_names();
      const auto found = std::ranges::find(known, bone);
      if (found == known.end()) {
        faults_.add("\"joints\": no bone " + in_quotes(bone) + faults_.suggestion(bone, known));
      } else {
        profile_.names[kAllBones[found - known.begin()]] =
            texts(value, "\"joints\", " + in_quotes(bone));
      }
    }
  }

  void read_parents() {
    for (const auto& [joint, parent] : members_.object("parents").items()) {
      if (parent.is_string()) {
        profile_.parents.emplace_back(joint, parent.get<std::string>());
      } else {
        faults_.add("\"parents\", " + in_quotes(joint) + " must be a string, found " +
                    short_text(parent));
      }
    }
  }

  void read_directions() {
    for (const auto& [joint, value] : members_.object("directions").items()) {
      const auto vector = direction(value, "\"directions\", " + in_quotes(joint));
      if (vector) profile_.directions.emplace_back(joint, *vector);
    }
  }

  const JsonMembers members_;
  Faults& faults_;
  SkeletonProfile profile_;
};

struct ParsedProfile {
  std::string text;
  SkeletonProfile profile;
};

}  // namespace

Result<SkeletonProfile> parse_skeleton_profile(std::string_view text, const std::string& name,
                                               const std::string& file) {
  TRY_ASSIGN(const auto json, parse_json(text, file));
  if (!json.is_object()) return config_failure(file, "a skeleton profile must be a JSON object");
  Faults faults;
  SkeletonProfile profile = SkeletonProfileReader(json, faults).read(name);
  if (!faults.empty()) return faults.failure_in(file, "the skeleton profile");
  return profile;
}

Result<std::vector<SkeletonProfile>> load_skeleton_profiles(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".json") files.push_back(entry->path());
  }
  if (error) return config_failure(folder.string(), "cannot read the folder: " + error.message());
  if (files.empty())
    return config_failure(folder.string(), "the folder holds no skeleton profile (*.json)");
  std::ranges::sort(files);

  // A batch asks for each clip; parsing takes longer than reading, and a tenth of a short clip's time.
  thread_local std::map<std::filesystem::path, ParsedProfile> parsed;
  std::vector<SkeletonProfile> profiles;
  for (const std::filesystem::path& path : files) {
    TRY_ASSIGN(const auto text, read_file(path.string(), ErrorKind::kConfig, kMaxTextBytes));
    auto known = parsed.find(path);
    if (known == parsed.end() || known->second.text != text.view()) {
      TRY_ASSIGN(auto profile,
                 parse_skeleton_profile(text.view(), path.stem().string(), path.string()));
      const ParsedProfile now{std::string(text.view()), std::move(profile)};
      known = parsed.insert_or_assign(path, now).first;
    }
    profiles.push_back(known->second.profile);
  }
  return profiles;
}

}  // namespace retarget
