#include "solve/targets/check_offsets.h"

#include <fmt/format.h>
#include <array>
#include <cstddef>
#include <vector>

#include "retarget/human.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "robot/anatomy/limbs.h"

namespace retarget {
namespace {

// The part of a robot's limb that a bone of a thigh, shin, upper arm or forearm means; null: none.
const LimbPart* part_of(const RobotAnatomy& anatomy, Bone bone) {
  for (std::size_t side = 0; side < 2; ++side) {
    const auto is = [&](LimbBone part) { return bone == side_bone(kSides[side], part); };
    if (anatomy.has_legs && is(LimbBone::kUpLeg)) return &anatomy.legs[side].upper;
    if (anatomy.has_legs && is(LimbBone::kLeg)) return &anatomy.legs[side].lower;
    if (is(LimbBone::kArm)) return &anatomy.arms[side].upper;
    if (is(LimbBone::kForeArm)) return &anatomy.arms[side].lower;
  }
  return nullptr;
}

}  // namespace

std::string wrong_offsets(const Robot& robot, const ResolvedConfig& config) {
  const auto anatomy = find_limbs(robot, robot.name());
  if (!anatomy) return {};
  std::vector<std::string> wrong;
  for (const ConfigTask& task : config.match_tables[0].tasks) {
    const LimbPart* part = part_of(*anatomy, task.bone);
    if (part == nullptr || part->body != task.body || task.rotation_weight == 0.0) continue;
    const Eigen::Matrix3d body_from_bone = task.rotation_offset.toRotationMatrix().transpose();
    const double angle = angle_between(body_from_bone.col(0), part->body_from_bone.col(0));
    if (angle <= kWrongOffset) continue;
    wrong.push_back(fmt::format("\"{}\" ({}) by {:.0f} degrees", robot.bodies()[task.body].name,
                                bone_name(task.bone), angle * 180.0 / std::numbers::pi));
  }
  if (wrong.empty()) return {};
  constexpr std::size_t kShown = 4;
  return fmt::format(
      "the rotation offsets of {} belong to another model than {}, or to another skeleton: they "
      "turn limbs away from their directions, {}",
      config.file, robot.name(), list_names(wrong, kShown));
}

}  // namespace retarget
