#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "human/gait/surface_contacts.h"
#include "retarget/contact_plan.h"
#include "retarget/kinematic_tree.h"
#include "retarget/options.h"
#include "retarget/solved_scene.h"
#include "scene/scene_world.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Smallest upward component of the normal of a surface that carries a body: a slope of 45 degrees.
inline constexpr double kLevelSurface = 0.7;

/// Depth by which a foot's shapes may extend below its sole, metres.
inline constexpr double kFootShapeDepth = 0.005;

/// A support body that touches, approaches or leaves a surface of the scene in a frame.
struct SceneGoal {
  int support = 0;                                    ///< Index into FitModel::supports.
  int body = 0;                                       ///< Index of the scene's body.
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    ///< Point on the surface, world, metres.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Outward surface normal there, world.
  double distance = 0.0;  ///< Desired distance from the surface, metres; positive only before and
                          ///< after the contact.
  double share = 0.0;     ///< Factor for the weights, 0 to 1.
  int phase = -1;         ///< Index of the contact.
  bool sticks = false;    ///< Whether the contact does not slide.
  bool held = false;      ///< Whether `place` is the robot's contact position (hold_contacts()).
  /// Direction in the link's frame that must face the surface, for hands; zero: no goal.
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
};

/// The scaled scene around a robot, the points of the robot that must stay outside its bodies, and
/// the contacts with them. Constant during a solve.
struct FitScene {
  SceneWorld world;  ///< Scene at the robot's scale, in the clip's frames.
  std::vector<std::vector<FloorPoint>> points;  ///< Spheres that cover the shapes, by link.
  std::vector<BoundingSphere> spheres;          ///< Spheres around the points of each link.
  std::vector<SceneGoal> goals;                 ///< Goals of all frames in order.
  std::vector<std::uint32_t> first_goal;        ///< Index of each frame's first goal, then the
                                                ///< number of goals.
  /// Factor of the smoothness terms of joints, by frame: 1 away from contacts. A robot with other
  /// proportions than its human reaches surfaces in other poses, and would touch them with jolts.
  std::vector<double> joint_smoothness;

  [[nodiscard]] std::span<const SceneGoal> goals_of(int frame) const {
    const auto begin = first_goal[static_cast<std::size_t>(frame)];
    return std::span(goals).subspan(begin, first_goal[static_cast<std::size_t>(frame) + 1] - begin);
  }
  /// Whether a part is in contact with the top of a body at rest, which may carry the robot. A wall
  /// does not.
  [[nodiscard]] bool may_carry(const SceneGoal& goal) const {
    return goal.share >= 1.0 && goal.normal.z() > kLevelSurface &&
           world.is_fixed(static_cast<std::size_t>(goal.body));
  }
};

/// Makes the scene around a robot from that around its human.
/// @param phases   contacts of the human with the scene.
/// @param scale    scale from the human's to the robot's paths, and of static bodies.
/// @param targets  frame-major, one per task of the model.
[[nodiscard]] FitScene make_fit_scene(const FitModel& model, const SceneWorld& human_world,
                                      const SurfaceParts& parts,
                                      std::span<const SurfacePhase> phases, double scale,
                                      double frame_time, std::span<const TaskTarget> targets);

/// Makes FitScene::joint_smoothness: the factor is highest during contacts with the bodies of a
/// scene and in the 0.25 s before and after.
/// @param solved    scene with the contacts of set_contacts().
/// @param contacts  contacts of the feet, see find_contacts_on_ground().
[[nodiscard]] std::vector<double> smoothness_near_contacts(const SolvedScene& solved,
                                                           const ContactPlan& contacts,
                                                           int frame_count, double frame_time);

/// Moves the goal of each sticking contact to the robot's mean position in a solved clip, and marks
/// it as held. The first solve follows the human's contact positions only loosely, because the
/// robot's arms have other lengths. The second solve holds the robot's own positions.
/// @param qpos  the solved clip, frame-major, laid out as in RobotClip.
/// @return whether there is any such contact.
bool hold_contacts(const FitModel& model, std::span<const double> qpos, FitScene& scene);

}  // namespace retarget
