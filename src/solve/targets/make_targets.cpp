#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/try.h"
#include "human/skeleton/human_clip.h"
#include "retarget/human.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/text.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/targets.h"
#include "solve/targets/trunk_aim.h"

namespace retarget {
namespace {

// Reports the mapped bones that the source lacks, and the bones that it has.
Result<void> check_bones(const HumanClipInfo& human, const TargetBuilder& targets,
                         const std::string& config) {
  std::vector<std::string> missing;
  for (const Bone bone : targets.bones()) {
    if (!human.has(bone)) missing.emplace_back(bone_name(bone));
  }
  if (missing.empty()) return {};
  return input_failure(
      {},
      fmt::format("the skeleton has no joint for the bone{} {}, which the configuration "
                  "{} uses",
                  missing.size() == 1 ? "" : "s", list_names(missing), config),
      "the file has " + list_names(human.source_joints));
}

Result<LimbLengths> measured_human(const HumanClipInfo& human, const HumanPoseSource& poses,
                                   bool forearms) {
  for (const Bone bone : kMeasuredBones) {
    if (human.has(bone)) continue;
    return input_failure(
        {}, fmt::format("limbs cannot be measured: no joint found for {}", bone_name(bone)),
        kOtherScaleHint);
  }
  if (const auto& built = human.built) {
    return LimbLengths{built->leg, built->upper_arm + (forearms ? built->forearm : 0.0),
                       built->trunk.norm()};
  }
  HumanPose world_from_bone;
  poses(0, world_from_bone);
  const LimbLengths lengths = human_limb_lengths(world_from_bone, forearms);
  if (lengths.leg > 0.0 && lengths.arm > 0.0 && lengths.trunk > 0.0) return lengths;
  return input_failure({}, "a limb of the body has zero length", kOtherScaleHint);
}

std::optional<TrunkAim> make_trunk_aim(const HumanClipInfo& human, const HumanPoseSource& poses,
                                       const Robot& robot, const ResolvedConfig& config,
                                       const RobotLimbs& limbs, const LimitSet& limits) {
  auto trunk = robot_trunk(robot, config, limbs, limits);
  const ConfigTask* const hips = config.find_task(Bone::kHips);
  if (!trunk || hips == nullptr) return std::nullopt;
  TrunkAim aim(std::move(*trunk), standing_trunk_lines(human, poses), hips->rotation_offset);
  if (human.built) aim.follow_robot();
  return aim;
}

}  // namespace

Result<TargetBuilder> make_targets(const HumanClipInfo& human, const HumanPoseSource& poses,
                                   const Robot& robot, const ResolvedConfig& config,
                                   ScaleRule scale, TrunkRule trunk, const LimitSet* limits) {
  const double height = scale == ScaleRule::kTable ? human.height : human.size;
  TargetBuilder targets(config, height, scale);
  TRY(check_bones(human, targets, config.file));
  if (const auto held = held_base(robot, config)) {
    targets.hold(*held);
    if (trunk == TrunkRule::kLines && !human.built) targets.aim_limbs(config);
    return targets;
  }
  if (scale != ScaleRule::kLimbs || human.frame_count == 0) return targets;
  TRY_ASSIGN(const RobotLimbs limbs, robot_limbs(robot, config));
  TRY_ASSIGN(const LimbLengths body, measured_human(human, poses, limbs.forearms));
  TargetBuilder by_limbs(config, limbs, body,
                         trunk == TrunkRule::kLines
                             ? make_trunk_aim(human, poses, robot, config, limbs,
                                              limits == nullptr ? robot.model_limits() : *limits)
                             : std::nullopt);
  if (human.built) by_limbs.keep_bones();
  return by_limbs;
}

}  // namespace retarget
