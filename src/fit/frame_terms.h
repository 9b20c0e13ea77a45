#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "fit/fit_model.h"
#include "retarget/options.h"
#include "robot/composite.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// What a fit weighs against each other; see docs/fit.md.
enum FitTerm : unsigned char {
  kTermPosition,
  kTermRotation,
  kTermFootHeight,
  kTermContactPlace,
  kTermContactHeight,
  kTermFloor,
  kTermSelfCollision,
  kTermSmoothness,
  kTermSpeed,
  kTermCount
};

using TermCosts = std::array<double, kTermCount>;

/// Where a task's body should be, its rotation given as that of its link.
struct TaskTarget {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond world_from_link = Eigen::Quaterniond::Identity();
};

/// What one end of a foot, heel or toe, should do in a frame.
struct FootEndGoal {
  double clearance = 0.0;   ///< Metres above the floor.
  double importance = 1.0;  ///< Factor to the weight of the clearance: more in flight, 0: lies.
  int phase = -1;           ///< Contact phase; -1: none.
  bool level = false;       ///< In contact, its height is that of what it stands on as well.
  double support = 0.0;     ///< How high that is, metres; 0: the floor.
};

/// What something that carries the robot besides its feet should do in a frame.
struct SupportGoal {
  int phase = -1;       ///< Contact phase; -1: none.
  double place = 0.0;   ///< Factor to the weight of its place,
  double height = 0.0;  ///< and of its height, which count little at a phase's ends; 0 to 1.
};

/// A frame's goals.
struct FrameGoals {
  std::span<const TaskTarget> targets;       ///< By task.
  std::span<const FootEndGoal> ends;         ///< Two a foot: heel, toe.
  std::span<const double> upright;           ///< By foot, 0 to 1: 0 for feet that lie or kneel.
  std::span<const Eigen::Vector2d> anchors;  ///< Place of each contact phase.
  double anchor_hold = 1.0;                  ///< Factor to the weight of these places.
  std::span<const SupportGoal> supports;     ///< By SupportBody; empty: none.
};

/// Weights of the squared error of a task's position, by the world's axes: an upright foot has its
/// height from the clearance of heel and toe.
[[nodiscard]] Eigen::Vector3d position_weights(const FitTask& task, const FrameGoals& goals);
/// Rotation vector from what a link's rotation should be to what it is, world axes, radians.
[[nodiscard]] Eigen::Vector3d rotation_error(const Pose& world_from_link, const TaskTarget& target);

/// Metres around the margin of self-collision over which shapes begin to push each other away.
inline constexpr double kOverlapBand = 0.002;

/// How deep one foot is in another.
struct FootOverlap {
  double depth = 0.0;  ///< Metres; 0: feet are apart.
  int foot_a = 0, foot_b = 0;
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< a moved along it moves away from b.
};

/// The terms of the cost that concern one frame alone: cost, gradient and Gauss-Newton Hessian.
/// Owns its scratch memory.
class FrameTerms {
 public:
  FrameTerms(const FitModel& model, const FitOptions& options);

  /// Adds up one frame.
  /// @param pairs     indices of the model's shape pairs that may be near.
  /// @param gradient  dof_count() values, written.
  /// @param hessian   rows of `stride` values: the lower triangle is written, all of it.
  /// @param costs     added to.
  void assemble(const TreeState& pose, const FrameGoals& goals,
                std::span<const std::uint32_t> pairs, double* gradient, double* hessian, int stride,
                TermCosts& costs);

  /// The deepest overlap of one foot with another in the frame that was assembled last.
  [[nodiscard]] const FootOverlap& foot_overlap() const { return foot_overlap_; }

  /// Pairs of shapes that are less than `within` metres apart.
  void find_near_pairs(const TreeState& pose, double within, std::vector<std::uint32_t>& pairs);

 private:
  void add_targets(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_feet(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_foot_end(const TreeState& pose, const FitFoot& foot, const FitFoot::End& end,
                    const FootEndGoal& goal, const FrameGoals& goals, TermCosts& costs);
  void add_lying_foot(const TreeState& pose, std::size_t foot, const FrameGoals& goals,
                      TermCosts& costs);
  void add_supports(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_floor(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_pair(const TreeState& pose, const FitPair& pair, double* gradient, double* hessian,
                int stride, TermCosts& costs);
  void add_row(int link, int axis, const Eigen::Vector3d& from_root, double weight,
               double residual);

  const FitModel& model_;
  const FitOptions& options_;
  std::vector<Composite> composites_;                      // by link
  std::vector<double> tree_hessian_;                       // as assemble writes it
  std::vector<Eigen::Vector3d> centres_, sphere_centres_;  // of shapes, of links' shapes; world
  std::vector<double> row_;
  std::vector<int> row_dofs_;
  FootOverlap foot_overlap_;
};

}  // namespace retarget
