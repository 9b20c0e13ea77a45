#include <Eigen/Core>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "app/plan/robot_source.h"
#include "base/option_name.h"
#include "base/try.h"
#include "formats/bvh/read_bvh.h"
#include "formats/registry/format.h"
#include "human/skeleton/bone_map.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/joint_clip.h"
#include "human/skeleton/limb_directions.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/recognise.h"
#include "human/skeleton/robot_human.h"
#include "human/skeleton/units.h"
#include "motion/clip.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/file.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {
namespace {

// The bend is a property of the skeleton and the person: all parts of the clip have the same.
std::optional<double> bend_of_clip(const Clip& clip, const Calibration& calibration) {
  HumanPoser poser(clip, calibration);
  const HumanClipInfo info = poser.info();
  if (info.frame_count == 0 || !has_trunk(info)) return std::nullopt;
  return standing_bend(info, poses_of(poser));
}

Result<Clip> load(const std::string& file, const SourceOptions& options, bool skeleton_only) {
  TRY(check_robot_source(options));
  const std::string name = file == "-" ? "standard input" : file;
  TRY(check_no_folder(file));
  TRY(check_start_of_large_file(file));
  const std::size_t max_bytes = memory_share(options.memory_gb);
  TRY_ASSIGN(const auto bytes, read_file(file, ErrorKind::kInput, max_bytes, kLargeFileHint));
  TRY_ASSIGN(HumanFile human,
             read_human_file(bytes.view(), name, {options, skeleton_only, max_bytes}));
  if (auto* clip = std::get_if<Clip>(&human)) return std::move(*clip);
  TRY_ASSIGN(Clip clip, clip_of_joints(std::get<JointMotion>(human), name));
  ClipOrigin origin = clip.origin();
  origin.bytes = bytes.view().size();
  clip.set_origin(std::move(origin));
  return clip;
}

Result<CalibrationOptions> calibration_options(const HumanOptions& options, const Clip& clip) {
  TRY(check_human_options(options));
  CalibrationOptions result;
  TRY_ASSIGN(result.metres_per_unit, unit_from_text(options.unit));
  result.unit_optional = options.unit_optional;
  result.up = options.up;
  result.forward = options.forward;
  result.height =
      options.height > 0.0 ? std::optional<double>(options.height) : clip.origin().body_height;
  result.rest = options.tpose_frame >= 0 ? RestPose::kFrame : options.rest;
  result.rest_frame = std::max(options.tpose_frame, 0);
  if (options.tpose_file.empty()) return result;
  BvhReadOptions read;
  read.motion_optional = true;
  TRY_ASSIGN(BvhFile tpose, load_bvh(options.tpose_file, read));
  result.tpose = std::move(tpose.clip);
  return result;
}

Result<BoneMap> recognise(const Clip& clip, const HumanOptions& options,
                          const std::string& data_folder) {
  std::filesystem::path folder = data_folder;
  if (folder.empty()) {
    TRY_ASSIGN(folder, find_data_folder(DataFolder{}));
  }
  TRY_ASSIGN(const auto known, load_skeleton_profiles(folder / "configs" / "skeletons"));
  RecogniseOptions how;
  how.partial = options.partial;
  return recognise_skeleton(clip, known, how);
}

// Whether a map contradicts another one nowhere: its bones have the same joints or none.
bool is_part_of(const BoneMap& map, const BoneMap& whole) {
  return std::ranges::all_of(kMappedBones, [&](Bone bone) {
    return !map.has(bone) || map.joint(bone) == whole.joint(bone);
  });
}

// A map from a file replaces the recognised one. The axes, the rest pose and the height of a known
// kind of skeleton still apply if the file changes no joint.
Result<BoneMap> find_bones(const Clip& clip, const HumanOptions& options,
                           const std::string& data_folder) {
  if (options.map.empty()) return recognise(clip, options, data_folder);
  TRY_ASSIGN(BoneMap map, read_bone_map(options.map, clip.skeleton()));
  const auto found = recognise(clip, options, data_folder);
  if (!found || !is_part_of(map, *found)) return map;
  if (map.joint_of_bone == found->joint_of_bone) return *found;
  map.profile = found->profile;
  map.confidence = found->confidence;
  map.facts = found->facts;
  return map;
}

}  // namespace

Result<void> check_no_folder(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || !std::filesystem::is_directory(path, ignored)) return {};
  return input_failure(path, "expected a motion file, found a directory",
                       "retarget batch " + path + " takes a folder of clips");
}

Result<Clip> load_clip(const std::string& file, const SourceOptions& options,
                       const DataFolder& data_folder) {
  if (!options.from_robot.empty()) return load_robot_clip(file, options, data_folder);
  return load(file, options, false);
}

Result<Clip> load_skeleton(const std::string& file, const SourceOptions& options) {
  if (!options.from_robot.empty()) {
    return usage_failure(
        OPTION("from-robot") " describes a robot motion, but a skeleton was requested", "omit it");
  }
  return load(file, options, true);
}

Result<HumanInClip> find_human(Clip& clip, const HumanOptions& options,
                               const std::string& data_folder) {
  if (is_of_robot(clip)) {
    // Only the up axis is unknown.
    TRY(check_human_of_robot(options));
    BoneMap map = bone_map_of_robot(clip);
    Calibration calibration = calibration_of_robot(clip, map);
    settle_robot_up(clip, map, options.up, calibration);
    return HumanInClip{std::move(map), std::move(calibration)};
  }
  TRY_ASSIGN(const CalibrationOptions how, calibration_options(options, clip));
  TRY_ASSIGN(BoneMap map, find_bones(clip, options, data_folder));
  map.in_place = joints_in_place(clip);
  // Properties in the file override those of its kind.
  if (clip.origin().metres_per_unit) map.facts.metres_per_unit = clip.origin().metres_per_unit;
  std::vector<Warning> unit_doubts = repair_clip_units(clip, map);
  const auto doubt = let_directions_win(clip, map);
  TRY_ASSIGN(Calibration calibration, calibrate(clip, map, how));
  const Eigen::Vector3d up = calibration.human_from_source.row(2).transpose();
  auto root_doubt = find_missing_root(clip, map, up);
  if (!root_doubt && unit_doubts.empty()) root_doubt = doubt_root_path(clip, map, up);
  if (root_doubt) unit_doubts.push_back(*std::move(root_doubt));
  auto& doubts = calibration.doubts;
  if (const auto twisted = let_bends_win(clip, map, calibration)) doubts.push_back(*twisted);
  if (doubt) doubts.insert(doubts.begin(), *doubt);
  doubts.insert(doubts.begin(), unit_doubts.begin(), unit_doubts.end());
  calibration.standing_bend = bend_of_clip(clip, calibration);
  return HumanInClip{std::move(map), std::move(calibration)};
}

std::vector<Bone> HumanInClip::missing_bones() const {
  std::vector<Bone> missing(kAllBones.begin(), kAllBones.end());
  std::erase_if(missing, [this](Bone bone) { return calibration.bones[bone].position_joint >= 0; });
  return missing;
}

bool HumanInClip::is_lafan1() const {
  const std::string& profile = calibration.profile;
  // A skeleton with LAFAN1's joints but another height is not treated as LAFAN1.
  return (profile == "lafan1" || profile == "lafan1_resolved") &&
         calibration.rest_pose != "lafan1 axes";
}

}  // namespace retarget
