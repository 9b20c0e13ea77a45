#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// Source of the rotations of pelvis, torso and limbs with limb scaling (ScaleRule::kLimbs).
enum class TrunkRule : unsigned char {
  kBones,  ///< The rotations of the bones, as published.
  kLines,  ///< The lines between the joints of trunk and limbs, so that both lean like the human's.
};

/// Share of the rotation weight with which a body follows a guessed rotation.
inline constexpr double kGuessedRotationShare = 0.3;

/// Weights and offsets with which a robot body follows a bone.
struct IkTask {
  double position_weight = 0.0;
  double rotation_weight = 0.0;
  Eigen::Vector3d position_offset = Eigen::Vector3d::Zero();  ///< Offset in the target's frame,
                                                              ///< metres.
  /// bone_from_body: the body's orientation relative to the bone.
  Eigen::Quaterniond rotation_offset = Eigen::Quaterniond::Identity();

  /// Whether the source does not state the rotation of the bone, which follows its neighbours. The
  /// body then follows it with kGuessedRotationShare of its weight, so that its joints do not
  /// drift.
  bool rotation_is_guess = false;

  [[nodiscard]] bool has_weight() const { return position_weight != 0.0 || rotation_weight != 0.0; }
  /// Whether the body should have the rotation of the bone.
  [[nodiscard]] bool compares_rotation() const {
    return rotation_weight > 0.0 && !rotation_is_guess;
  }
};

/// One row of a retargeting configuration: a robot body follows a human bone.
struct IkMatch : IkTask {
  std::string body;
  std::string bone;
};

/// A table of a retargeting configuration, in file order: the order of the tasks.
struct IkMatchTable {
  bool used = true;  ///< `use_ik_match_tableN`; false: the solver skips the table.
  std::vector<IkMatch> rows;
};

/// A retargeting configuration from a human to a robot as read, in the schema of GMR (General
/// Motion Retargeting). Reading does not check names; resolve_config resolves them for a robot.
///
/// The file has these keys:
/// - `robot_root_name`, `human_root_name`: root body and root bone.
/// - `ground_height`: every target is lowered by this distance, in the target's frame, metres.
/// - `human_height_assumption`: body height that the scales are made for, metres.
/// - `human_scale_table`: scale of each bone's distance from the root; the root's own scale applies
///   to its distance from the origin.
/// - `use_ik_match_table1`, `use_ik_match_table2`: whether the solver runs this pass.
/// - `ik_match_table1`, `ik_match_table2`: tasks, as
///   `body: [bone, position weight, rotation weight, [x, y, z], [w, x, y, z]]`.
struct RetargetingConfig {
  std::string file;  ///< File name for messages.
  std::string robot_root;
  std::string human_root;
  double ground_height = 0.0;                          ///< Metres.
  double human_height_assumption = 1.8;                ///< Metres.
  std::vector<std::pair<std::string, double>> scales;  ///< Pairs of bone and scale.
  std::array<IkMatchTable, 2> match_tables;

  /// The scale of a bone; null if the configuration has none.
  [[nodiscard]] const double* find_scale(std::string_view bone) const;
};

/// Reads a retargeting configuration and normalises its quaternions. Errors (kConfig): syntax
/// errors with line and column; else all wrong types, missing keys, and quaternions whose norm
/// differs from 1 by more than 1e-3, together.
[[nodiscard]] Result<RetargetingConfig> parse_retargeting_config(std::string_view text,
                                                                 const std::string& file);
[[nodiscard]] Result<RetargetingConfig> load_retargeting_config(const std::string& path);

/// A task with resolved names: a robot body follows a bone.
struct ConfigTask : IkTask {
  int body = -1;  ///< Index into Robot::bodies(); -1 in an unused table: the robot has no such
                  ///< body.
  Bone bone = Bone::kHips;
};

/// A retargeting configuration for one robot. All names are resolved and checked against robot and
/// human.
struct ResolvedConfig {
  struct Table {
    bool used = true;
    std::vector<ConfigTask> tasks;  ///< Tasks in file order.
  };
  std::string file;   ///< File name for messages.
  int root_body = 0;  ///< Index into Robot::bodies().
  Bone root_bone = Bone::kHips;
  double ground_height = 0.0;            ///< See RetargetingConfig::ground_height.
  double human_height_assumption = 1.8;  ///< Metres.
  BoneArray<double> scales{1.0};  ///< Scales of bones with tasks in use, and of the root bone.
  std::array<Table, 2> match_tables;

  /// The first task of a bone with a weight, else its first task; null if the bone has no task.
  /// Includes unused tables.
  [[nodiscard]] const ConfigTask* find_task(Bone bone) const;
  /// The body of find_task(bone); -1: no task.
  [[nodiscard]] int body_of(Bone bone) const;
};

/// Resolves the body and bone names of a retargeting configuration. Errors (kConfig), all at once:
/// unknown bodies and bones (with the nearest name), bones without a scale, two bodies on one bone,
/// an unknown root, no task at all. Unused tables are not checked; the result has only their rows
/// with a known bone.
[[nodiscard]] Result<ResolvedConfig> resolve_config(const RetargetingConfig& config,
                                                    const Robot& robot);
/// Reads and resolves a retargeting configuration. Reports errors in the file and in its names
/// together.
[[nodiscard]] Result<ResolvedConfig> load_config(const std::string& path, const Robot& robot);

/// A retargeting configuration for one robot and for a human whose bodies have their own names.
struct HumanConfig {
  ResolvedConfig tables;  ///< Index i stands for bodies[i] instead of bone i.
  /// Bodies of the human that the root or the rows name, the root first.
  std::vector<std::string> bodies;
};

/// Resolves a configuration for a robot like resolve_config, but accepts any names of the human's
/// bodies, such as those of SMPL-X. Errors (kConfig): those of resolve_config, more bodies than
/// bones.
[[nodiscard]] Result<HumanConfig> resolve_human_config(const RetargetingConfig& config,
                                                       const Robot& robot);

/// Removes the tasks of these bones from both tables, for human bodies without an arm or a leg.
/// @return the number of removed tasks; a kConfig error if no task remains.
[[nodiscard]] Result<int> leave_out_bones(ResolvedConfig& config, std::span<const Bone> bones);

// The steps of the published method from a bone to its target.

/// Scales a position about the root: p' = s (p - p_root) + p_root'.
/// @param root, scaled_root  the root before and after scaling, metres.
[[nodiscard]] inline Eigen::Vector3d scaled_about_root(const Eigen::Vector3d& position,
                                                       double scale, const Eigen::Vector3d& root,
                                                       const Eigen::Vector3d& scaled_root) {
  return scale * (position - root) + scaled_root;
}

/// Target rotation q' = q r. The inputs need not be normalised, but must be non-zero.
[[nodiscard]] inline Eigen::Quaterniond offset_rotation(
    const Eigen::Quaterniond& world_from_bone, const Eigen::Quaterniond& bone_from_target) {
  return (world_from_bone.normalized() * bone_from_target).normalized();
}

/// Target pose with position offset: p'' = p' + q' o.
/// @param offset  offset in the target's frame, metres.
[[nodiscard]] inline Pose offset_target(const Eigen::Quaterniond& world_from_target,
                                        const Eigen::Vector3d& scaled,
                                        const Eigen::Vector3d& offset) {
  return {world_from_target, scaled + world_from_target * offset};
}

}  // namespace retarget
