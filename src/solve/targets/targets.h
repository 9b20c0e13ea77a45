#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "solve/ik/ik_solver.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/trunk_aim.h"
#include "solve/targets/trunk_lines.h"

namespace retarget {

/// The transform of a human's poses for a robot with a fixed base (Robot::fixed_base). The base
/// corresponds to the configuration's root bone. If that is the hips, the transform removes only
/// their position and heading, so that the trunk still leans relative to the vertical. If it is the
/// chest of an upper body, the transform removes the chest's full rotation, so that the arms move
/// as they do relative to the chest.
///
/// Let q be the root bone's world rotation and T its rotation for a human who stands and faces +x.
/// The reference frame has the rotation q T^-1; for the hips, only its rotation about the vertical.
/// The transform maps this frame to the frame of a human who stands and faces +x, in which the base
/// has its own orientation.
class HeldBase {
 public:
  HeldBase(const Robot& robot, const ResolvedConfig& config);

  /// Rotation from the human's world poses in a frame to the poses that the robot follows.
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

/// Transforms a human clip for a robot with a fixed base.
[[nodiscard]] HumanClip seen_by(const HeldBase& base, Bone root, HumanClip human);

/// World rotations of the two bones of a limb.
struct LimbAim {
  Eigen::Quaterniond upper = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond lower = Eigen::Quaterniond::Identity();
};

/// Rotations of a human limb's bones if its elbow or knee were a hinge: the X axes of both bones
/// point along the limb, and their Z axes along the hinge, which is perpendicular to the limb's
/// plane. Human bones also rotate about their own axes at elbow and knee. A robot that followed
/// these rotations could not also follow the directions of the limb. A straight limb defines no
/// plane, so the hinge also depends on the upper bone's own Z axis z:
///
///     n + (0.1 - min(0, n z)) z,    n = -(u x f)
///
/// with the directions u and f of the two bones.
///
/// @param upper, lower, end  poses of the bones that begin at shoulder, elbow and wrist (hip, knee,
///     ankle), with the axes of canonical_t_pose().
/// @return empty for a limb without length.
[[nodiscard]] std::optional<LimbAim> aim_limb(const Pose& upper, const Pose& lower,
                                              const Pose& end);

/// Computes the target poses of robot bodies from the poses of human bones, which are scaled about
/// the root and offset.
///
/// The formulas are in docs/ik.md ("From a human frame to targets"). The poses of a frame are world
/// poses, metres, Z up.
///
/// With limb scaling, a TrunkAim can determine the rotations of Hips and Spine2, so that the
/// robot's trunk leans like the human's. The targets of an arm are then shifted by the vector from
/// the middle of the shoulders, scaled by s_trunk, to that of the robot. The targets of a leg are
/// shifted by the vector from its hip, scaled by s_leg, to the robot's hip, because hip widths do
/// not scale with leg lengths.
///
/// For a robot with a fixed base, HeldBase finally transforms all targets and moves the root's
/// target to the base.
class TargetBuilder {
 public:
  /// Scales all bones about the root.
  /// @param height  height of the human, metres.
  TargetBuilder(const ResolvedConfig& config, double height, ScaleRule scale = ScaleRule::kTable);
  /// Scales limb by limb.
  /// @param trunk  determines the rotations of pelvis and torso; empty: the bones that they follow
  ///     do.
  TargetBuilder(const ResolvedConfig& config, const RobotLimbs& robot, const LimbLengths& human,
                std::optional<TrunkAim> trunk = std::nullopt);

  /// Makes arms and legs take the rotations of their bones, instead of those of aim_limb(). For the
  /// human of a robot: its elbows and knees are hinges, and its bones contain more information than
  /// the lines between its joints.
  void keep_bones() { aims_limbs_ = false; }

  /// Transforms the targets for a robot with a fixed base.
  void hold(const HeldBase& base) { held_ = base; }
  [[nodiscard]] bool base_is_held() const { return held_.has_value(); }
  /// Makes arms and legs take the rotations of aim_limb(). A TrunkAim implies this.
  void aim_limbs(const ResolvedConfig& config);

  [[nodiscard]] int target_count() const { return static_cast<int>(rules_.size()); }
  /// Bone of each target; the root is first.
  [[nodiscard]] std::vector<Bone> bones() const;
  /// Index of a bone's target; -1 if the bone has none.
  [[nodiscard]] int target_of(Bone bone) const;

  /// Computes the targets of a frame.
  /// @param world_from_bone    world poses of the bones, metres, Z up.
  /// @param world_from_target  target_count() poses; overwritten.
  void build(const HumanPose& world_from_bone, std::span<Pose> world_from_target) const;
  /// Whether the rotation of a target depends on aim_trunk().
  [[nodiscard]] bool is_of_trunk(int target) const;
  /// The robot's trunk in a frame, as TrunkAim::aim() finds it; empty without a TrunkAim.
  [[nodiscard]] std::optional<TrunkAim::Aimed> aim_trunk(const HumanPose& world_from_bone,
                                                         double min_step = TrunkAim::kExact) const {
    return trunk_ ? trunk_->aim(world_from_bone, min_step) : std::nullopt;
  }
  /// Computes the rotation of one target, the same as build().
  /// @param trunk  result of aim_trunk(); ignored for targets that do not depend on it.
  [[nodiscard]] Eigen::Quaterniond rotation(int target, const HumanPose& world_from_bone,
                                            const std::optional<TrunkAim::Aimed>& trunk) const;

 private:
  enum class Part : unsigned char { kOther, kPelvis, kTorso, kUpperLimb, kLowerLimb };
  struct Rule {
    Bone bone;
    double scale;
    // With limb scaling: the upper arm of a forearm or hand.
    std::optional<Bone> pivot = std::nullopt;
    Part part = Part::kOther;
    std::array<Bone, 3> limb{};  // For kUpperLimb and kLowerLimb: the limb's bones from its root.
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
  // With limb scaling only.
  bool by_limbs_ = false;
  bool aims_limbs_ = true;  // Has an effect only after aim_limbs().
  double leg_scale_ = 1.0, trunk_scale_ = 1.0;
  double lift_ = 0.0;  // Robot's ankle height minus the scaled human's, metres.
  std::optional<TrunkAim> trunk_;
  std::optional<HeldBase> held_;
};

/// Makes the target builder of a human clip for a scale rule.
///
/// Errors: the clip lacks a mapped bone or, with kLimbs, a bone that limb measurement requires
/// (kInput, without a file name); the robot's limbs cannot be measured (kConfig).
/// @param poses   called for some frames if limbs are measured.
/// @param limits  joint ranges that limit the waist with kLines; null: the model's limits.
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
