#include "solve/robot_setup/derive_config.h"

#include <array>
#include <optional>

#include "retarget/human.h"
#include "retarget/kinematic_tree.h"
#include "solve/robot_setup/format_model.h"

namespace retarget {
namespace {

constexpr HumanLengths kHuman;
constexpr double kHeightAssumption = 1.8;

// Rounds entries such as the cosine of a quarter turn to zero. Otherwise rounding errors would
// determine the sign of the quaternion.
Eigen::Matrix3d without_rounding(const Eigen::Matrix3d& rotation) {
  constexpr double kGrid = 1e12;
  return (kGrid * rotation).array().round() / kGrid;
}

// Task weights of a bone in one pass.
struct Weights {
  double position = 0.0, rotation = 0.0;
};

// Weights like those of the published tables. The first pass weights rotations and only the
// positions of the feet, the second pass all positions. The first pass has the largest weights on
// trunk and upper arms: an arm may be half a turn away from its target in the zero configuration,
// and a shoulder in a local minimum does not recover. Position weights of forearms and hands are
// low relative to the arm's rotation weights, because robots and humans have different shoulder
// positions.
Weights weights_of(Bone bone, int pass, int wrist_joints) {
  using enum LimbBone;
  const bool second = pass == 1;
  const std::optional<LimbBone> part = limb_bone(bone);
  if (bone == Bone::kHips) return {second ? 100.0 : 0.0, 10.0};
  if (part == kFootMod) return {50.0, 10.0};
  if (bone == Bone::kSpine2 || part == kArm) return {0.0, second ? 10.0 : 30.0};
  if (bone == Bone::kHead) return {0.0, 2.0};
  if (part == kUpLeg || part == kLeg) return {0.0, 10.0};
  if (part == kForeArm) return {second ? 5.0 : 0.0, 10.0};
  // A hand without a full wrist cannot match the human hand's rotation.
  const double rotation = wrist_joints >= 3 ? 5.0 : (wrist_joints > 0 ? 2.0 : 0.0);
  return {second ? 10.0 : 0.0, rotation};
}

class ConfigMaker {
 public:
  ConfigMaker(const Robot& robot, const RobotAnatomy& limbs, const DeriveOptions& options)
      : robot_(robot), limbs_(limbs), options_(options), scales_(derive_scales(limbs)) {
    if (!limbs.has_legs) return;
    const TreeState posed(robot.tree(), reference_configuration(robot));
    const auto root_of = [&](const Limb& limb) -> Eigen::Vector3d {
      return posed.world_from_body(limb.upper.body) * limb.upper.joint;
    };
    const Eigen::Vector3d left = root_of(limbs.legs[0]);
    const Eigen::Vector3d right = root_of(limbs.legs[1]);
    wider_ = 0.5 * (left - right).norm() - scales_.leg * kHuman.hip_width;
    higher_ =
        options.sole_height > 0.0 ? options.sole_height - scales_.leg * kHuman.ankle_height : 0.0;
    hips_in_pelvis_ = posed.world_from_body(limbs.pelvis).inverse() *
                      (0.5 * (left + right) - scales_.leg * kHuman.hips_behind * limbs.forward);
  }

  [[nodiscard]] RetargetingConfig make() const;

 private:
  [[nodiscard]] Eigen::Vector3d position_offset(const BonePart& part) const;

  const Robot& robot_;
  const RobotAnatomy& limbs_;
  DeriveOptions options_;
  DerivedScales scales_;
  double wider_ = 0.0;   // Half the robot's hip width minus the scaled human's, metres.
  double higher_ = 0.0;  // The robot's ankle height minus the scaled human's, metres.
  Eigen::Vector3d hips_in_pelvis_ = Eigen::Vector3d::Zero();
};

// The offset from the joint to the body's origin in the body's frame, with the differences in hip
// width and ankle height.
Eigen::Vector3d ConfigMaker::position_offset(const BonePart& part) const {
  using enum LimbBone;
  const Eigen::Matrix3d& axes = part.part.body_from_bone;
  if (part.bone == Bone::kHips) return higher_ * axes.col(0) - hips_in_pelvis_;
  if (part.bone == Bone::kSpine2 || part.bone == Bone::kHead) return Eigen::Vector3d::Zero();
  // The Z axis of leg bones points right.
  const double side = side_of(part.bone) == Side::kLeft ? 1.0 : -1.0;
  const std::optional<LimbBone> of_limb = limb_bone(part.bone);
  const Eigen::Vector3d aside = -side * wider_ * axes.col(2);
  if (of_limb == kUpLeg || of_limb == kLeg) {
    return aside - higher_ * axes.col(0) - part.part.joint;
  }
  if (of_limb == kFootMod) return aside + higher_ * axes.col(1) - part.part.joint;
  return -part.part.joint;
}

RetargetingConfig ConfigMaker::make() const {
  constexpr double kWholeHeight = kHuman.height / kHeightAssumption;
  RetargetingConfig config;
  config.robot_root = robot_.bodies()[limbs_.pelvis].name;
  config.human_root = std::string(bone_name(bone_parts(limbs_).front().bone));
  config.human_height_assumption = kHeightAssumption;
  for (const BonePart& part : bone_parts(limbs_)) {
    const std::string name(bone_name(part.bone));
    const auto of_limb = limb_bone(part.bone);
    const bool of_arm =
        of_limb == LimbBone::kArm || of_limb == LimbBone::kForeArm || of_limb == LimbBone::kHand;
    const double scale = (of_arm ? scales_.arm : scales_.leg) / kWholeHeight;
    config.scales.emplace_back(name, rounded(scale, 4));
    const Limb& arm = limbs_.arms[side_of(part.bone) == Side::kLeft ? 0 : 1];
    for (int pass = 0; pass < 2; ++pass) {
      Weights weights = weights_of(part.bone, pass, arm.end_joints);
      // The position of an upper body is unrelated to the human's, so its limbs have only rotation
      // weights.
      if (!limbs_.has_legs) weights.position = 0.0;
      IkMatch row;
      row.body = robot_.bodies()[part.part.body].name;
      row.bone = name;
      row.position_weight = weights.position;
      row.rotation_weight = weights.rotation;
      row.position_offset = position_offset(part);
      row.rotation_offset =
          Eigen::Quaterniond(without_rounding(part.part.body_from_bone.transpose())).normalized();
      config.match_tables[pass].rows.push_back(row);
    }
  }
  return config;
}

std::string list_of(std::initializer_list<double> values, int digits) {
  std::string text = "[";
  for (const double value : values) {
    if (text.size() > 1) text += ", ";
    text += number_text(rounded(value, digits));
  }
  return text + "]";
}

}  // namespace

DerivedScales derive_scales(const RobotAnatomy& limbs) {
  const auto mean_length = [](const std::array<Limb, 2>& pair) {
    return 0.5 * (pair[0].upper_length + pair[0].lower_length + pair[1].upper_length +
                  pair[1].lower_length);
  };
  DerivedScales scales;
  scales.arm = mean_length(limbs.arms) / (kHuman.upper_arm + kHuman.forearm);
  scales.leg = limbs.has_legs ? mean_length(limbs.legs) / (kHuman.thigh + kHuman.shin) : scales.arm;
  return scales;
}

RetargetingConfig derive_config(const Robot& robot, const RobotAnatomy& limbs,
                                const DeriveOptions& options) {
  return ConfigMaker(robot, limbs, options).make();
}

std::string format_retargeting_config(const RetargetingConfig& config) {
  const auto quoted = json_text;
  std::string text = "{\n";
  text += "  \"robot_root_name\": " + quoted(config.robot_root) + ",\n";
  text += "  \"human_root_name\": " + quoted(config.human_root) + ",\n";
  text += "  \"ground_height\": " + number_text(config.ground_height) + ",\n";
  text += "  \"human_height_assumption\": " + number_text(config.human_height_assumption) + ",\n";
  text += "  \"human_scale_table\": {";
  for (std::size_t i = 0; i < config.scales.size(); ++i) {
    const auto& [bone, scale] = config.scales[i];
    text += (i == 0 ? "\n    " : ",\n    ") + quoted(bone) + ": " + number_text(scale);
  }
  text += "\n  }";
  for (std::size_t t = 0; t < 2; ++t) {
    const IkMatchTable& table = config.match_tables[t];
    const std::string key = "ik_match_table" + std::to_string(t + 1);
    text += ",\n  \"use_" + key + "\": " + (table.used ? "true" : "false");
    text += ",\n  \"" + key + "\": {";
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const IkMatch& row = table.rows[i];
      const Eigen::Vector3d& p = row.position_offset;
      const Eigen::Quaterniond& q = row.rotation_offset;
      text += (i == 0 ? "\n    " : ",\n    ") + quoted(row.body) + ": [" + quoted(row.bone) + ", " +
              number_text(row.position_weight) + ", " + number_text(row.rotation_weight) + ", " +
              list_of({p.x(), p.y(), p.z()}, 5) + ", " + list_of({q.w(), q.x(), q.y(), q.z()}, 8) +
              "]";
    }
    text += "\n  }";
  }
  return text + "\n}\n";
}

}  // namespace retarget
