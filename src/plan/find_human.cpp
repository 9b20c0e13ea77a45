#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/try.h"
#include "bvh/read_bvh.h"
#include "human/bone_map_file.h"
#include "human/calibrate.h"
#include "human/limb_directions.h"
#include "human/recognise.h"
#include "human/robot_human.h"
#include "options/run_tables.h"
#include "plan/check_options.h"
#include "plan/robot_source.h"
#include "retarget/clip.h"
#include "retarget/human.h"
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
  TRY_ASSIGN(const auto known, load_skeleton_profiles(data_folder + "/configs/skeletons"));
  RecogniseOptions recognise;
  recognise.partial = options.partial;
  return recognise_skeleton(clip, known, recognise);
}

}  // namespace

Result<HumanInClip> find_human(Clip& clip, const HumanOptions& options,
                               const std::string& data_folder) {
  if (is_of_robot(clip)) {
    // nothing has to be found
    TRY(check_human_of_robot(options));
    BoneMap map = bone_map_of_robot(clip);
    Calibration calibration = calibration_of_robot(clip, map);
    return HumanInClip{std::move(map), std::move(calibration)};
  }
  TRY_ASSIGN(const CalibrationOptions how, calibration_options(options, clip));
  TRY_ASSIGN(BoneMap map, find_bones(clip, options, data_folder));
  // what the file says of itself is nearer than what files of its kind are like
  if (clip.origin().metres_per_unit) map.facts.metres_per_unit = clip.origin().metres_per_unit;
  if (clip.origin().up) map.facts.up = clip.origin().up;
  const auto doubt = let_directions_win(clip, map);
  TRY_ASSIGN(Calibration calibration, calibrate(clip, map, how));
  auto& doubts = calibration.doubts;
  if (doubt) doubts.insert(doubts.begin(), *doubt);
  return HumanInClip{std::move(map), std::move(calibration)};
}

std::vector<Bone> HumanInClip::missing_bones() const {
  std::vector<Bone> missing(kAllBones.begin(), kAllBones.end());
  std::erase_if(missing, [this](Bone bone) { return calibration.bones[bone].position_joint >= 0; });
  return missing;
}

bool HumanInClip::is_lafan1() const {
  const std::string& profile = calibration.profile;
  // joints like LAFAN1's of a body that is not as tall are not its
  return (profile == "lafan1" || profile == "lafan1_resolved") &&
         calibration.rest_pose != "lafan1 axes";
}

}  // namespace retarget
