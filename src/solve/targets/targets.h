#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "human/skeleton/human_clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "solve/ik/ik_solver.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/trunk_aim.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {

/// The transform of a human for a robot with a fixed base (Robot::fixed_base). The base represents
/// the body part of the configuration's root bone. A base that represents the hips removes only
/// their position and heading, so the trunk leans relative to the vertical. A base that represents
/// the chest of an upper body removes the chest's whole rotation, so the arms move as they do
/// relative to the chest.
///
/// Let q be the root bone's world rotation and T its rotation for a human who stands facing +x. The
/// reference frame is q T^-1; for the hips, only its rotation about the vertical. Poses in this
/// frame are transferred unchanged to the frame in which the base has its own orientation when the
/// human stands facing +x.
class HeldBase {
 public:
  HeldBase(const Robot& robot, const ResolvedConfig& config);

  /// Rotation that transforms the human's world poses of this frame to those that the robot
  /// follows.
  [[nodiscard]] Eigen::Quaterniond turn(const HumanPose& world_from_bone) const;
  /// Position of the base, to which the root bone is moved; world, metres.
  [[nodiscard]] const Eigen::Vector3d& place() const { return place_; }

 private:
  Bone root_;
  Eigen::Quaterniond standing_from_root_;  // Equals T^-1.
  // Rotation from a human who stands facing +x to the base.
  Eigen::Quaterniond base_from_standing_;
  Eigen::Vector3d place_;
};

/// Returns nothing for a robot with a floating base.
[[nodiscard]] std::optional<HeldBase> held_base(const Robot& robot, const ResolvedConfig& config);

/// Transforms a human clip for a robot with a fixed base.
[[nodiscard]] HumanClip seen_by(const HeldBase& base, Bone root, HumanClip human);

/// World rotations of the two bones of a limb.
struct LimbAim {
  Eigen::Quaterniond upper = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond lower = Eigen::Quaterniond::Identity();
};

/// Aims a human limb as if its elbow or knee were a hinge: the X axes of both bones point along the
/// limb, their Z axes are perpendicular to the limb's plane. Human bones also rotate about their own axes at
/// elbow and knee; a robot that followed these rotations would have to point its limbs elsewhere.
/// The straighter the limb, the less its plane is defined, so the upper bone's own Z counts more.
/// The hinge is along
///
///     n + (0.1 - min(0, n z)) z,    n = -(u x f)
///
/// with the directions u and f of both bones and the upper bone's Z axis z.
///
/// Returns nothing for a limb without length.
/// @param upper, lower, end  poses of the bones that begin at shoulder, elbow and wrist (hip, knee,
///     ankle), with the axes of canonical_t_pose.
[[nodiscard]] std::optional<LimbAim> aim_limb(const Pose& upper, const Pose& lower,
                                              const Pose& end);

/// Computes target poses of robot bodies: human bones, scaled about the root and offset.
///
/// For the bones of a frame (world poses, metres, Z up) and the scale s_b of a bone, which is its
/// scale in the configuration times height / human_height_assumption (kNormalised: 1.75 m /
/// human_height_assumption times 1.75 m / height):
///   root:    p' = s_root p              (about the origin of the world)
///   others:  p' = s_root p_root + s_b (p - p_root)
///   all:     q' = q r_b,  p'' = p' + q' (o_b - [0, 0, ground_height])
/// Here r_b and o_b are the offsets of table 1, also for the second pass; a bone that table 1 does
/// not use has the offsets of table 2.
///
/// Limb by limb, h is the middle of the human's hips, s of leg, trunk or arm is the robot's length
/// over the human's, and c_b is the position of the bone's joint in the body that follows it:
///   h' = s_leg h + [0, 0, ankle height of the robot - s_leg times that of the human]
///   root:                      p' = h' - q' c
///   legs, trunk, neck, head:   p' = h' + s (p - h) - q' c
///   forearms and hands:        p' = h' + s_trunk (p_Arm - h) + s_arm (p - p_Arm) - q' c
/// The ankles of the human stand at 0.0794 leg lengths (Drillis and Contini 1966). The last step is
/// as above, but without o_b, which compensates for the scales of the table.
///
/// Limb by limb, a TrunkAim can determine the rotations of Hips and Spine2 instead, so that the
/// robot's trunk leans as the human's. Arms then move with the robot's shoulders, by the vector
/// from the s_trunk-scaled middle of the shoulders to the robot's. Each leg moves with its hip, by
/// the vector from the s_leg-scaled hip to the robot's, because the widths of hips do not scale
/// with leg lengths.
///
/// For a robot with a fixed base, all targets are finally transformed by HeldBase, which places the
/// root's target at the base.
class TargetBuilder {
 public:
  /// @param height  height of the human, metres.
  TargetBuilder(const ResolvedConfig& config, double height, ScaleRule scale = ScaleRule::kTable);
  /// Scales limb by limb.
  /// @param trunk  determines how pelvis and torso turn; without it, they turn as the bones that
  ///     they follow.
  TargetBuilder(const ResolvedConfig& config, const RobotLimbs& robot, const LimbLengths& human,
                std::optional<TrunkAim> trunk = std::nullopt);

  /// Makes arms and legs turn as their bones. For the human of a robot: its elbows and knees are
  /// hinges already, and its bones hold more information than the lines between joints.
  void keep_bones() { aims_limbs_ = false; }

  /// Transforms the targets for a robot with a fixed base.
  void hold(const HeldBase& base) { held_ = base; }
  [[nodiscard]] bool base_is_held() const { return held_.has_value(); }
  /// Makes arms and legs point along the lines between their joints, as with a TrunkAim.
  void aim_limbs(const ResolvedConfig& config);

  [[nodiscard]] int target_count() const { return static_cast<int>(rules_.size()); }
  /// Bone of each target; the root is first.
  [[nodiscard]] std::vector<Bone> bones() const;
  /// Index of a bone's target; -1 if the bone has none.
  [[nodiscard]] int target_of(Bone bone) const;

  /// @param world_from_target  target_count() poses; overwritten.
  void build(const HumanPose& world_from_bone, std::span<Pose> world_from_target) const;

 private:
  enum class Part : unsigned char { kOther, kPelvis, kTorso, kUpperLimb, kLowerLimb };
  struct Rule {
    Bone bone;
    double scale;
    std::optional<Bone> pivot = std::nullopt;  // Limb by limb: the upper arm of a forearm or hand.
    Part part = Part::kOther;
    std::array<Bone, 3> limb{};  // For parts of limbs: bones from the limb's root outwards.
    bool of_arm = false;
    double leg_side = 0.0;            // For parts of legs: +1 left, -1 right.
    Eigen::Vector3d position_offset;  // In the target's frame, minus the ground height; metres.
    Eigen::Quaterniond bone_from_target;
  };
  void add_rules(const ResolvedConfig& config);

  void find_parts(std::optional<Bone> torso);
  [[nodiscard]] Eigen::Quaterniond rotation_of(const Rule& rule, const HumanPose& world_from_bone,
                                               const std::optional<TrunkAim::Aimed>& aimed) const;
  [[nodiscard]] Eigen::Vector3d scaled_limb(const Rule& rule,
                                            const HumanPose& world_from_bone) const;

  std::vector<Rule> rules_;  // The root is first.
  // Used only limb by limb.
  bool by_limbs_ = false;
  bool aims_limbs_ = true;  // Only with a TrunkAim.
  double leg_scale_ = 1.0, trunk_scale_ = 1.0;
  double lift_ = 0.0;  // Metres.
  std::optional<TrunkAim> trunk_;
  std::optional<HeldBase> held_;
};

/// Creates the targets of a human's clip for a scale rule.
///
/// Errors: a mapped bone that the clip lacks or, for kLimbs, bones needed to measure its limbs
/// (kInput, without a file name); a robot whose limbs cannot be measured (kConfig).
/// @param poses   called for single frames if limbs are measured.
/// @param limits  range of the waist joints for kLines; null: the model's limits.
[[nodiscard]] Result<TargetBuilder> make_targets(const HumanClipInfo& human,
                                                 const HumanPoseSource& poses, const Robot& robot,
                                                 const ResolvedConfig& config, ScaleRule scale,
                                                 TrunkRule trunk = TrunkRule::kBones,
                                                 const LimitSet* limits = nullptr);

/// The IK problem that a retargeting configuration defines for a robot: one task per row with a
/// weight, in file order, without unused tables.
[[nodiscard]] std::shared_ptr<const IkProblem> make_problem(std::shared_ptr<const Robot> robot,
                                                            const ResolvedConfig& config,
                                                            const TargetBuilder& targets,
                                                            const LimitSet& limits);

}  // namespace retarget
