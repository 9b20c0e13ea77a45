#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "human/gait/source_feet.h"
#include "retarget/human.h"
#include "retarget/kinematic_tree.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "retarget/shape_distance.h"
#include "solve/dynamics/inertias.h"
#include "solve/targets/support_bodies.h"

namespace retarget {

/// Leg length (hip to knee to ankle) of a G1, metres. Weights per metre are tuned for this size.
inline constexpr double kUsualLeg = 0.632;

/// A robot body that follows a target.
struct FitTask {
  int link = 0;
  int target = 0;                                      ///< Index into the targets of a frame.
  Bone bone = Bone::kHips;                             ///< The bone that the body follows.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< Position of the body in the link frame,
                                                       ///< metres.
  Eigen::Quaterniond link_from_body = Eigen::Quaterniond::Identity();
  double horizontal_weight = 0.0, height_weight = 0.0;  ///< Weights per metre.
  double rotation_weight = 0.0;                         ///< Weight per radian.
  /// Weight per radian of rotations about twist_axis, a unit vector in the link frame.
  double twist_weight = 0.0;
  Eigen::Vector3d twist_axis = Eigen::Vector3d::UnitX();
  int forearm = -1;             ///< Of an upper arm: index of the forearm's task; -1: none.
  double straight_twist = 1.0;  ///< Share of twist_weight while the elbow is straight.
  int foot = -1;                ///< Index into FitModel::feet if the body is a foot; else -1.
  std::string body;             ///< Name of the body.

  [[nodiscard]] bool follows_rotation() const {
    return rotation_weight > 0.0 || twist_weight > 0.0;
  }
};

/// Target position of a task's body (world frame, metres) and target rotation of its link.
struct TaskTarget {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond world_from_link = Eigen::Quaterniond::Identity();
  double twist_share = 1.0;  ///< Factor for FitTask::twist_weight.
};

/// A sphere, in the link frame, that must stay above the floor; metres.
struct FloorPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// A foot and the points of its sole, in the link frame, metres.
struct FitFoot {
  /// One end of a sole: heel or toe.
  struct End {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< Mean of the corners; a contact holds
                                                       ///< this point.
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();     ///< Outermost point of the centre line.
    std::vector<Eigen::Vector3d> points;               ///< All sole points of this end.
    double half_width = 0.0;                           ///< Distance from the centre line to the
                                                       ///< corners.
    std::vector<FloorPoint> shape_points;  ///< Points of the foot's shapes nearer to this end.
  };
  int link = 0;
  bool left = true;
  std::array<End, 2> ends;                              ///< Heel, toe.
  Eigen::Vector3d sideways = Eigen::Vector3d::UnitY();  ///< Direction in the plane of the sole,
                                                        ///< perpendicular to its length.
  double body_height = 0.0;                             ///< Height of the body's origin above the
                                                        ///< sole.
  int body = 0;                                         ///< Index into Robot::bodies().
};

/// A collision shape in its link's frame.
struct FitShape : RoundedShape {
  int link = 0;
};

/// Two shapes that must not collide; indices into FitModel::shapes.
struct FitPair {
  int a = 0, b = 0;
};

/// The pairs [begin, end) between the shapes of two links.
struct FitPairGroup {
  int link_a = 0, link_b = 0;
  std::uint32_t begin = 0, end = 0;
};

/// A bounding sphere of all shapes of a link, in the link frame, metres.
struct BoundingSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// The data of a fit that depend only on robot, configuration and options. Constant during a fit.
/// Indices of links and degrees of freedom refer to the tree.
struct FitModel {
  KinematicTree tree;  ///< Contains all joints.
  /// Limits by degree of freedom; infinite for a moving root, 0 for a fixed base.
  std::vector<double> lower, upper;
  bool base_is_held = false;
  std::vector<double> speed_limit;   ///< Limit by degree of freedom, rad/s or m/s; infinite if
                                     ///< unlimited.
  std::vector<double> torque_limit;  ///< Limit by link, N m or N; infinite if unknown.
  std::vector<double> smoothness;    ///< Weight by degree of freedom, per rad/s or m/s.
  std::vector<FitTask> tasks;
  std::vector<FitFoot> feet;
  std::vector<SupportBody> supports;                  ///< Other bodies that may carry the robot.
  std::vector<std::vector<FloorPoint>> floor_points;  ///< Points by link.
  std::vector<double> floor_reach;  ///< Largest distance of a floor point from the origin of its
                                    ///< link, metres, by link.
  std::vector<char> is_foot;        ///< Whether a link is a foot, by link.
  std::vector<int> foot_of_link;    ///< Index of the foot that is this link or a child of it; -1 if
                                    ///< there is none.
  std::vector<FitShape> shapes;
  std::vector<FitPair> pairs;  ///< Sorted by links.
  std::vector<FitPairGroup> pair_groups;
  std::vector<BoundingSphere> link_spheres;  ///< Spheres by link.
  int configuration_size = 0;                ///< Number of values of a qpos.
  Inertias inertias;
  double leg = kUsualLeg;  ///< Hip to knee to ankle, metres; the G1's if unknown.

  [[nodiscard]] int dof_count() const { return tree.dof_count(); }
};

/// Appends the targets of a frame, one per task.
/// @param world_from_target  one per target of the configuration.
/// @param offset             added to all positions, metres.
void append_targets(const FitModel& model, std::span<const Pose> world_from_target,
                    const Eigen::Vector3d& offset, std::vector<TaskTarget>& targets);

/// The sides on which the source has a whole leg with a foot.
struct SourceSides {
  bool left = true, right = true;
};

/// @param target_of_bone  index of each bone's target; -1 if the bone has none.
/// @param sides           sides on which the source has a foot. The model excludes the robot's
///     other feet, because they have nothing to follow.
[[nodiscard]] FitModel make_fit_model(const Robot& robot, const ResolvedConfig& config,
                                      const LimitSet& limits, const BoneArray<int>& target_of_bone,
                                      const FitOptions& options, const SourceSides& sides = {});

}  // namespace retarget
