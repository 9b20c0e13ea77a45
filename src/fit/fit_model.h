#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dynamics/inertias.h"
#include "human/source_feet.h"
#include "pipeline/support_bodies.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "robot/kinematic_tree.h"
#include "robot/shape_distance.h"

namespace retarget {

/// Hip to knee to ankle of a G1, metres: weights per metre are those of a robot of that size.
inline constexpr double kUsualLeg = 0.632;

/// A robot body that follows a target.
struct FitTask {
  int link = 0;
  int target = 0;                                      ///< Index into the targets of a frame.
  Bone bone = Bone::kHips;                             ///< That it follows.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Of the body, in the link.
  Eigen::Quaterniond link_from_body = Eigen::Quaterniond::Identity();
  double horizontal_weight = 0.0, height_weight = 0.0;  ///< Per metre.
  double rotation_weight = 0.0;                         ///< Per radian.
  int foot = -1;                                        ///< Index of the foot it is; -1: none.
  std::string body;
};

/// A point that must not go below the floor by more than its radius.
struct FloorPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// A foot: where its sole may touch, in the link's frame.
struct FitFoot {
  /// One end of a sole: heel or toe.
  struct End {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< Of its corners: what is pinned.
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();     ///< Outermost point of the middle line.
    std::vector<Eigen::Vector3d> points;               ///< All of them.
    double half_width = 0.0;                           ///< From the middle line to the corners.
    std::vector<FloorPoint> shape_points;  ///< Of the foot's shapes, nearer to this end.
  };
  int link = 0;
  bool left = true;
  std::array<End, 2> ends;                              ///< Heel, toe.
  Eigen::Vector3d sideways = Eigen::Vector3d::UnitY();  ///< Along the sole, square to its length.
  double body_height = 0.0;                             ///< Of the body's origin above the sole.
  int body = 0;
};

/// A collision shape in its link's frame.
struct FitShape : RoundedShape {
  int link = 0;
};

/// Two shapes that must stay apart.
struct FitPair {
  int a = 0, b = 0;
};

/// The pairs [begin, end) of the shapes of two links.
struct FitPairGroup {
  int link_a = 0, link_b = 0;
  std::uint32_t begin = 0, end = 0;
};

/// A sphere that holds all shapes of a link, in its frame.
struct BoundingSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// All that a fit takes from robot, configuration and options; the same for every frame. Immutable.
/// Links and degrees of freedom are the tree's.
struct FitModel {
  KinematicTree tree;  ///< Of all joints.
  /// By degree of freedom; infinite for the root, 0 where the base stands fast.
  std::vector<double> lower, upper;
  bool base_is_held = false;
  std::vector<double> speed_limit;  ///< By degree of freedom, rad/s or m/s; infinite: none.
  std::vector<double> smoothness;   ///< Weight by degree of freedom, per rad/s or m/s.
  std::vector<FitTask> tasks;
  std::vector<FitFoot> feet;
  std::vector<SupportBody> supports;                  ///< What else may carry the robot.
  std::vector<std::vector<FloorPoint>> floor_points;  ///< By link.
  std::vector<double> floor_reach;  ///< By link: no floor point is farther from the origin.
  std::vector<char> is_foot;        ///< By link.
  std::vector<int> foot_of_link;    ///< Index of the foot that a link is or carries next; -1: none.
  std::vector<FitShape> shapes;
  std::vector<FitPair> pairs;  ///< Ordered by links.
  std::vector<FitPairGroup> pair_groups;
  std::vector<BoundingSphere> link_spheres;  ///< By link.
  int configuration_size = 0;
  Inertias inertias;
  double leg = kUsualLeg;  ///< Hip to knee to ankle, metres; the G1's where it is not known.

  [[nodiscard]] int dof_count() const { return tree.dof_count(); }
};

/// Of which sides the source has a whole leg with a foot.
struct SourceSides {
  bool left = true, right = true;
};

/// @param target_of_bone  index of a bone's target, -1: none.
/// @param sides  the robot's feet of the other sides follow nothing and are none of the model's.
[[nodiscard]] FitModel make_fit_model(const Robot& robot, const ResolvedConfig& config,
                                      const LimitSet& limits, const BoneArray<int>& target_of_bone,
                                      const FitOptions& options, const SourceSides& sides = {});

}  // namespace retarget
