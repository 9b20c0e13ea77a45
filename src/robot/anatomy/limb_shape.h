#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/kinematic_tree.h"
#include "retarget/robot.h"
#include "robot/anatomy/branches.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Points and axis of a limb in the reference configuration, in the world frame.
struct LimbShape {
  std::vector<int> joints;
  int middle = 0;         ///< Index into `joints`.
  Eigen::Vector3d root;   ///< Intersection of the joints before the middle one.
  Eigen::Vector3d bend;   ///< Point on the middle joint's axis, level with root and end.
  Eigen::Vector3d end;    ///< Intersection of the joints beyond the middle, or the limb's end.
  Eigen::Vector3d axis;   ///< Axis of the middle joint.
  double straight = 0.0;  ///< Position of the middle joint that makes the limb straight.
  double flexion = 0.0;  ///< Sign of the positions that bend the limb; 0 if the range is symmetric.
  double clarity = 0.0;
  std::vector<double> scores;  ///< Score of each joint of the chain as middle joint; 0: unsuitable.
  std::size_t at_root = 0;     ///< Joints directly before the middle one that bend the limb at the
                               ///< same place.
  std::size_t at_end = 0;      ///< Joints directly beyond the middle one that do so.
  std::optional<int> toe;      ///< First toe joint, which is excluded from a leg.
  bool end_is_estimated = false;
  std::optional<int> end_body;  ///< Body at the limb's end that is fixed to the last body, if any.

  /// Returns the unit directions of the two segments, perpendicular to the axis.
  [[nodiscard]] Eigen::Vector3d upper() const;
  [[nodiscard]] Eigen::Vector3d lower() const;
};

/// Splits a chain at its knee or elbow. Returns nothing if no hinge splits it into two segments of
/// plausible lengths. The rest of the limb affects the score (plausibility); names decide if
/// another joint fits nearly as well.
///
/// Hinges next to the middle one that bend the limb at the same place (two-hinge knees and elbows)
/// count as part of it. A toe of up to three joints at the end of a leg is excluded. An arm whose
/// joints beyond the elbow all pass it has no wrist: a body fixed to its last body marks its end,
/// otherwise its masses do, otherwise the twist axis gives the direction and human proportions give
/// the forearm's length.
///
/// Legs bend in one plane: their hip and ankle points are moved onto the hinge there that is most
/// parallel to the knee. Forearms whose joints beyond the elbow all twist the forearm end at the
/// farthest body fixed to the last of them.
/// @param reference  the configuration of `posed`.
/// @param forward    the facing direction, or its opposite.
/// @param at         the middle joint, if known: index into the chain.
[[nodiscard]] std::optional<LimbShape> shape_limb(const Robot& robot, const TreeState& posed,
                                                  const std::vector<double>& reference,
                                                  const std::vector<int>& chain, bool is_leg,
                                                  const Eigen::Vector3d& forward,
                                                  std::optional<int> at = std::nullopt);

/// Returns the points of a moving body and the bodies fixed to it, in the world frame of `posed`:
/// body origins and corners of the boxes around geoms.
[[nodiscard]] std::vector<Eigen::Vector3d> outline_points(const Robot& robot,
                                                          const TreeState& posed, int body);

/// Shapes of a pair's limbs; index 0 is the first branch, towards which `across` points.
struct ShapedPair {
  BranchPair pair;
  std::array<LimbShape, 2> limbs;
};

/// The pairs of branches that are a robot's legs and arms, left and right in any order.
struct LimbPairs {
  ShapedPair legs;  ///< Legs; without joints for a robot with a fixed base.
  ShapedPair arms;
  double lean = 0.0;  ///< Lean of the line from hips to shoulders, degrees; 0 without legs.
};

/// Chooses the legs, the pair of branches that reaches lowest, and the arms, the remaining pair
/// with the most joints; for a robot with a fixed base only the arms, the highest pair.
///
/// @param posed  the tree in the configuration `reference` (reference_configuration).
/// @param file  the model, for errors (kConfig): those of find_limbs that concern legs and arms.
[[nodiscard]] Result<LimbPairs> find_limb_pairs(const Robot& robot, const TreeState& posed,
                                                const std::vector<double>& reference,
                                                const std::string& file);

/// The error that a model is not a humanoid with two legs and two arms.
/// @param found  describes the model instead.
/// @param hint  describes possible causes; a fixed base is suggested in any case.
[[nodiscard]] Failure no_legs_failure(const std::string& file, const std::string& found,
                                      const std::string& hint = {});

/// A candidate for a limb's knee or elbow.
struct MiddleJoint {
  const std::vector<int>& chain;  ///< All joints of the limb, from the trunk outwards.
  int index = 0;                  ///< Index into the chain.
  int before = 0;                 ///< Number of joints that move the segment before it.
  bool is_leg = false;
};

/// Returns the plausibility of a knee or elbow from the other parts of the limb: a factor of at
/// most 1 on its geometric score. The factor is lower for a hip or shoulder of one joint, which
/// cannot aim the limb; for a small joint range; and for a segment with almost no mass.
[[nodiscard]] double plausibility(const Robot& robot, const MiddleJoint& middle);

/// Classifies a joint or body by its name: +1 a knee or elbow, -1 another part of the limb, 0
/// unknown.
[[nodiscard]] int middle_vote_of_name(const std::string& any_case, bool is_leg);

/// Classifies a joint by its name and its body's name, likewise.
[[nodiscard]] int middle_vote_of_names(const Robot& robot, int joint, bool is_leg);

/// Limbs that the names of a joint and its body mention.
struct LimbNames {
  bool leg = false, arm = false;
};
[[nodiscard]] LimbNames limb_named_by(const Robot& robot, int joint);

/// Observations in the zero configuration.
struct ZeroPose {
  double lean = 0.0;       ///< Lean of the line from hips to shoulders, degrees.
  double foot_tilt = 0.0;  ///< Largest angle between a foot's underside and the floor, degrees.
  std::optional<int> toe;  ///< Joint excluded at the end of the left leg, if any.
};

/// Adds unusual decisions to RobotAnatomy::notes.
void note_limbs(const Robot& robot, const ZeroPose& zero, RobotAnatomy& found);

/// Adds ambiguous knees and elbows to RobotAnatomy::doubts: another joint fits nearly as well, or
/// one segment is shorter than 0.4 of the other.
void doubt_limbs(const Robot& robot, RobotAnatomy& found);

/// Adds limb segments whose lengths differ between left and right to RobotAnatomy::doubts.
void doubt_sides(RobotAnatomy& found);

}  // namespace retarget
