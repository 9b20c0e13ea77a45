#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/plan/robot_source.h"
#include "base/try.h"
#include "formats/bvh/read_bvh.h"
#include "human/skeleton/bone_map_file.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/clip_units.h"
#include "human/skeleton/limb_directions.h"
#include "human/skeleton/limb_twists.h"
#include "human/skeleton/recognise.h"
#include "human/skeleton/robot_human.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"

namespace retarget {
namespace {

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

Result<BoneMap> find_bones(const Clip& clip, const HumanOptions& options,
                           const std::string& data_folder) {
  if (!options.map.empty()) return read_bone_map(options.map, clip.skeleton());
  std::filesystem::path folder = data_folder;
  if (folder.empty()) {
    TRY_ASSIGN(folder, find_data_folder(DataFolder{}));
  }
  TRY_ASSIGN(const auto known, load_skeleton_profiles(folder / "configs" / "skeletons"));
  RecogniseOptions recognise;
  recognise.partial = options.partial;
  return recognise_skeleton(clip, known, recognise);
}

}  // namespace

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
  // Properties in the file override those of its kind.
  if (clip.origin().metres_per_unit) map.facts.metres_per_unit = clip.origin().metres_per_unit;
  const std::vector<Warning> unit_doubts = mend_clip_units(clip, map);
  const auto doubt = let_directions_win(clip, map);
  TRY_ASSIGN(Calibration calibration, calibrate(clip, map, how));
  auto& doubts = calibration.doubts;
  if (const auto twisted = let_bends_win(clip, map, calibration)) doubts.push_back(*twisted);
  if (doubt) doubts.insert(doubts.begin(), *doubt);
  doubts.insert(doubts.begin(), unit_doubts.begin(), unit_doubts.end());
  return HumanInClip{std::move(map), std::move(calibration)};
}

std::vector<Bone> HumanInClip::missing_bones() const {
  std::vector<Bone> missing(kAllBones.begin(), kAllBones.end());
  std::erase_if(missing, [this](Bone bone) { return calibration.bones[bone].position_joint >= 0; });
  return missing;
}

bool HumanInClip::is_lafan1() const {
  const std::string& profile = calibration.profile;
  // A skeleton with LAFAN1's joints but another height does not count as LAFAN1.
  return (profile == "lafan1" || profile == "lafan1_resolved") &&
         calibration.rest_pose != "lafan1 axes";
}

}  // namespace retarget
