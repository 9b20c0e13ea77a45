#pragma once

#include <memory>
#include <span>
#include <vector>

#include "retarget/human/bones.h"
#include "retarget/ik/ik_solver.h"
#include "retarget/math/pose.h"
#include "retarget/pipeline/ik_tables.h"

namespace retarget {

/// How the height of the body scales a human to a robot.
enum class HeightScale : unsigned char {
  /// As the published method: in proportion to the height, which it takes to be 1.75 m whoever is
  /// recorded.
  kPublished,
  /// Inversely: every body is brought to the size of the published one first, so that a child and
  /// a giant who move alike give one robot motion.
  kNormalised,
};

/// Where the robot's bodies should be: human bones, scaled about the root and offset.
///
/// With the bones of a frame (world poses, metres, Z up) and s_b the scale of a bone in the mapping
/// times height / human_height_assumption (kNormalised: 1.75 m / human_height_assumption times
/// 1.75 m / height):
///   root:    p' = s_root p              (about the origin of the world)
///   others:  p' = s_root p_root + s_b (p - p_root)
///   all:     q' = q r_b,  p'' = p' + q' (o_b - [0, 0, ground_height])
/// where r_b and o_b are the offsets of table 1 also for the second pass; a bone that table 1 does
/// not use has those of table 2.
class TargetBuilder {
 public:
  /// @param tables  checked by check_ik_tables.
  /// @param height  of the human body, metres.
  TargetBuilder(const IkTables& tables, double height, HeightScale scale = HeightScale::kPublished);

  [[nodiscard]] int target_count() const { return static_cast<int>(rules_.size()); }
  /// Bone of each target, an index into kBoneNames; the root first.
  [[nodiscard]] std::vector<int> bones() const;
  /// Index of a bone's target; -1 for bones without one.
  [[nodiscard]] int target_of(int bone) const;

  /// @param world_from_bone    kBoneCount poses.
  /// @param world_from_target  target_count() poses, filled.
  void build(std::span<const Pose> world_from_bone, std::span<Pose> world_from_target) const;

 private:
  struct Rule {
    int bone;
    double scale;
    Eigen::Vector3d position_offset;  // in the target's frame, ground taken off
    Eigen::Quaterniond bone_from_target;
  };
  std::vector<Rule> rules_;  // the root first
};

/// The problem that a mapping poses on a robot: one task per row with a weight, in file order;
/// tables that are not used are left out.
[[nodiscard]] std::shared_ptr<const IkProblem> make_problem(std::shared_ptr<const Robot> robot,
                                                            const IkTables& tables,
                                                            const TargetBuilder& targets,
                                                            const LimitSet& limits);

}  // namespace retarget
