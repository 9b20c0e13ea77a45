#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/options.h"
#include "robot/model/composite.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/fit_scene.h"
#include "solve/fit/near_pairs.h"

namespace retarget {

/// The terms of the fit's cost; see docs/fit.md.
enum FitTerm : unsigned char {
  kTermPosition,
  kTermRotation,
  kTermFootHeight,
  kTermContactPlace,
  kTermContactHeight,
  kTermFloor,
  kTermSelfCollision,
  kTermLimits,
  kTermSmoothness,
  kTermSpeed,
  kTermSceneContact,
  kTermScene,
  kTermCount
};

/// Terms of every fit; the rest needs a scene.
inline constexpr int kTermsWithoutScene = kTermSceneContact;

using TermCosts = std::array<double, kTermCount>;

/// The goal of one foot end (heel or toe) in a frame.
struct FootEndGoal {
  double clearance = 0.0;   ///< Height above the floor, metres.
  double importance = 1.0;  ///< Factor for the clearance weight; larger in flight, 0 for a lying
                            ///< foot.
  int phase = -1;           ///< Index of the contact phase; -1 if not in contact.
  bool level = false;       ///< Whether the contact also prescribes the height.
  double support = 0.0;  ///< Height of the contact surface, or of the surface of a scene below an
                         ///< end that is not in contact, metres; 0: the floor.
  int near_phase = -1;   ///< Index of a contact phase that ends just before, or begins just
                         ///< after, this frame; -1 in contact.
  double hold = 1.0;     ///< Factor for the weight of the anchor of either phase.
  /// Target position relative to the anchor of near_phase: the movement of the source. World x and
  /// y, metres.
  Eigen::Vector2d slide = Eigen::Vector2d::Zero();
  /// Share, 0 to 1, in which the clearance replaces the height of the contact, because this end
  /// rises while the other one stays down.
  double lift = 0.0;
};

/// The goal of a support body in a frame.
struct SupportGoal {
  int phase = -1;  ///< Index of the contact phase; -1 if not in contact.
  /// Target position relative to the phase's anchor: the distance that the source has slid. World x
  /// and y, metres.
  Eigen::Vector2d slide = Eigen::Vector2d::Zero();
  double share = 0.0;  ///< Factor for the weights, 0 to 1; below 1 before and after the contact.
};

/// The goals of a frame.
struct FrameGoals {
  std::span<const TaskTarget> targets;  ///< One per task.
  std::span<const FootEndGoal> ends;    ///< Two per foot: heel, toe.
  std::span<const double> upright;      ///< Factor per foot, 0 to 1; 0 for feet that lie or kneel.
  std::span<const Eigen::Vector2d> anchors;  ///< One per contact phase: position to hold, world x
                                             ///< and y, metres.
  double anchor_hold = 1.0;                  ///< Factor for the weight of the anchors.
  std::span<const SupportGoal> supports;     ///< One per SupportBody; may be empty.
  std::span<const double> lying;    ///< One per foot, 0 to 1; 1 for feet that lie on the floor. May
                                    ///< be empty.
  const FitScene* scene = nullptr;  ///< Null: no scene.
  int frame = 0;                    ///< Frame of the scene.
};

/// Half-width of the band around the self-collision margin over which the term's curvature grows to
/// its full value, metres (OneSidedRow).
inline constexpr double kOverlapBand = 0.002;

/// The deepest overlap between two feet.
struct FootOverlap {
  double depth = 0.0;  ///< Metres; 0 if the feet are apart.
  int foot_a = 0, foot_b = 0;
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< Moving foot a along it separates the feet.
};

/// Cost, gradient and Gauss-Newton Hessian of the terms that depend on a single frame, all three
/// without the factor 2 of the squares' derivatives: cost = sum (w r)^2, gradient = J' w^2 r,
/// Hessian = J' w^2 J. Owns its scratch memory.
class FrameTerms {
 public:
  FrameTerms(const FitModel& model, const FitOptions& options);

  /// Assembles one frame.
  /// @param pairs     indices of the model's shape pairs that may be near each other.
  /// @param gradient  dof_count() values, overwritten.
  /// @param hessian   rows of `stride` values; the whole lower triangle is overwritten.
  /// @param costs     the costs are added to it.
  void assemble(const TreeState& pose, const FrameGoals& goals,
                std::span<const std::uint32_t> pairs, double* gradient, double* hessian, int stride,
                TermCosts& costs);

  /// Adds half of the self-collision term of a pose between two frames, for one of these frames.
  void add_crossings(const TreeState& half_way, std::span<const std::uint32_t> pairs,
                     double* gradient, double* hessian, int stride, TermCosts& costs);

  /// Adds the costs of one frame without its gradient and Hessian.
  void add_costs(const TreeState& pose, const FrameGoals& goals,
                 std::span<const std::uint32_t> pairs, TermCosts& costs);

  /// The deepest overlap between two feet in the last assembled frame.
  [[nodiscard]] const FootOverlap& foot_overlap() const { return foot_overlap_; }

  /// Finds the pairs of shapes that are less than `within` metres apart.
  void find_near_pairs(const TreeState& pose, double within, std::vector<std::uint32_t>& pairs) {
    near_pairs_.find(pose, within, pairs);
  }
  /// Updates a list of near pairs that is kept while distances change by at most `stay`.
  void update_near_pairs(const TreeState& pose, double within, double stay, NearList& list) {
    near_pairs_.update(pose, within, stay, list);
  }

 private:
  void add_terms(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_targets(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_feet(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_foot_end(const TreeState& pose, const FitFoot& foot, const FitFoot::End& end,
                    const FootEndGoal& goal, const FrameGoals& goals, TermCosts& costs);
  void add_lying_foot(const TreeState& pose, std::size_t foot, const FrameGoals& goals,
                      TermCosts& costs);
  void add_support_height(const TreeState& pose, const SupportBody& body, double weight,
                          TermCosts& costs);
  void add_supports(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_floor(const TreeState& pose, const FrameGoals& goals, TermCosts& costs);
  void add_pair(const TreeState& pose, const FitPair& pair, double share, double* gradient,
                double* hessian, int stride, TermCosts& costs);
  void add_row(int link, int axis, const Eigen::Vector3d& from_root, double weight,
               double residual);

  const FitModel& model_;
  const FitOptions& options_;
  std::vector<Composite> composites_;  // One per link.
  std::vector<double> tree_hessian_;   // Laid out as in assemble().
  std::vector<double> row_;
  std::vector<char> stands_;  // One per foot: whether it is in contact and does not lie.
  std::vector<int> row_dofs_;
  std::vector<SupportBody::Touch> touches_;  // Of one support body.
  NearPairs near_pairs_;
  FootOverlap foot_overlap_;
};

/// Adds the cost of joints near their limits to an assembled frame. The cost of a joint is zero at
/// a distance of 3 % of its range from a limit, and grows with the cube of the depth to
/// limit_margin_weight^2 / 2 at the limit.
/// @param qpos     configuration of the frame.
/// @param hessian  null: adds only the cost.
void add_limit_margins(const FitModel& model, const FitOptions& options,
                       std::span<const double> qpos, double* gradient, double* hessian, int stride,
                       TermCosts& costs);

}  // namespace retarget
