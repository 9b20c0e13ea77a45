#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "human/human_clip.h"
#include "ik/ik_solver.h"
#include "pipeline/held_base.h"
#include "pipeline/limb_lengths.h"
#include "pipeline/trunk_aim.h"
#include "pipeline/trunk_lines.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// Where the robot's bodies should be: human bones, scaled about the root and offset.
///
/// With the bones of a frame (world poses, metres, Z up) and s_b the scale of a bone in the configuration
/// times height / human_height_assumption (kNormalised: 1.75 m / human_height_assumption times
/// 1.75 m / height):
///   root:    p' = s_root p              (about the origin of the world)
///   others:  p' = s_root p_root + s_b (p - p_root)
///   all:     q' = q r_b,  p'' = p' + q' (o_b - [0, 0, ground_height])
/// or, limb by limb, with h the middle of the human's hips, s of leg, trunk or arm the robot's length
/// over the human's, and c_b where the bone's joint lies in the body that follows it:
///   h' = s_leg h + [0, 0, ankle height of the robot - s_leg times that of the human]
///   root:                      p' = h' - q' c
///   legs, trunk, neck, head:   p' = h' + s (p - h) - q' c
///   forearms and hands:        p' = h' + s_trunk (p_Arm - h) + s_arm (p - p_Arm) - q' c
/// the human's ankles standing at 0.0794 leg lengths (Drillis and Contini 1966), and then as above
/// but without o_b, which makes up for the table's scales.
/// Limb by limb, Hips and Spine2 may turn as a TrunkAim says instead, so that the robot's trunk leans
/// as the human's; arms are then moved along with its shoulders, by the way between where s_trunk has
/// the middle of the shoulders and where the robot's is, and each leg with its hip, by the way between
/// where s_leg has the hip and where the robot's is: hips are not as wide as legs are long.
/// All targets of a robot whose base stands fast are then seen from the base (HeldBase), with the root's
/// in its place.
/// Here r_b and o_b are the offsets of table 1 also for the second pass; a bone that table 1 does
/// not use has those of table 2.
class TargetBuilder {
 public:
  /// @param height  of the human body, metres.
  TargetBuilder(const ResolvedConfig& config, double height, ScaleRule scale = ScaleRule::kTable);
  /// Limb by limb.
  /// @param trunk  how pelvis and torso turn; without: as the bones that they follow.
  TargetBuilder(const ResolvedConfig& config, const RobotLimbs& robot, const LimbLengths& human,
                std::optional<TrunkAim> trunk = std::nullopt);

  /// Arms and legs turn as their bones from now on: those of a robot, whose elbows and knees are
  /// hinges already, and whose bones know more of them than the lines between joints.
  void keep_bones() { aims_limbs_ = false; }

  /// Targets are those of a human as a robot sees it whose base stands fast, from now on.
  void hold(const HeldBase& base) { held_ = base; }
  [[nodiscard]] bool base_is_held() const { return held_.has_value(); }
  /// Arms and legs point as the lines between their joints do, as with a TrunkAim.
  void aim_limbs(const ResolvedConfig& config);

  [[nodiscard]] int target_count() const { return static_cast<int>(rules_.size()); }
  /// Bone of each target; the root first.
  [[nodiscard]] std::vector<Bone> bones() const;
  /// Index of a bone's target; -1 for bones without one.
  [[nodiscard]] int target_of(Bone bone) const;

  /// @param world_from_target  target_count() poses, filled.
  void build(const HumanPose& world_from_bone, std::span<Pose> world_from_target) const;

 private:
  enum class Part : unsigned char { kOther, kPelvis, kTorso, kUpperLimb, kLowerLimb };
  struct Rule {
    Bone bone;
    double scale;
    std::optional<Bone> pivot = std::nullopt;  // limb by limb: the upper arm of a forearm or hand
    Part part = Part::kOther;
    std::array<Bone, 3> limb{};  // of a limb's part: bones from its root on
    bool of_arm = false;
    double leg_side = 0.0;            // of a leg's part: +1 left, -1 right
    Eigen::Vector3d position_offset;  // in the target's frame, ground taken off
    Eigen::Quaterniond bone_from_target;
  };
  void add_rules(const ResolvedConfig& config);

  void find_parts(std::optional<Bone> torso);
  [[nodiscard]] Eigen::Quaterniond rotation_of(const Rule& rule, const HumanPose& world_from_bone,
                                               const std::optional<TrunkAim::Aimed>& aimed) const;
  [[nodiscard]] Eigen::Vector3d scaled_limb(const Rule& rule,
                                            const HumanPose& world_from_bone) const;

  std::vector<Rule> rules_;  // the root first
  // limb by limb
  bool by_limbs_ = false;
  bool aims_limbs_ = true;  // with a TrunkAim
  double leg_scale_ = 1.0, trunk_scale_ = 1.0;
  double lift_ = 0.0;  // metres
  std::optional<TrunkAim> trunk_;
  std::optional<HeldBase> held_;
};

/// The targets of a human's clip under a way of scaling.
///
/// Errors, of which those of kInput name no file: a mapped bone that the clip lacks, for kLimbs
/// also bones without which its limbs cannot be measured (kInput); a robot whose limbs cannot be
/// (kConfig).
/// @param poses   asked for single frames when limbs are measured.
/// @param limits  how far the waist may turn, for kLines; null: the model's.
[[nodiscard]] Result<TargetBuilder> make_targets(const HumanClipInfo& human,
                                                 const HumanPoseSource& poses, const Robot& robot,
                                                 const ResolvedConfig& config, ScaleRule scale,
                                                 TrunkRule trunk = TrunkRule::kBones,
                                                 const LimitSet* limits = nullptr);

/// The problem that a retargeting configuration poses on a robot: one task per row with a weight,
/// in file order; tables that are not used are left out.
[[nodiscard]] std::shared_ptr<const IkProblem> make_problem(std::shared_ptr<const Robot> robot,
                                                            const ResolvedConfig& config,
                                                            const TargetBuilder& targets,
                                                            const LimitSet& limits);

}  // namespace retarget
