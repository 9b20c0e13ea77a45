#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "human/gait/surface_contacts.h"
#include "retarget/kinematic_tree.h"
#include "retarget/options.h"
#include "robot/model/composite.h"
#include "scene/scene_world.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// A support body that touches, approaches or leaves a surface of the scene in a frame.
struct SceneGoal {
  int support = 0;                                    ///< Index into FitModel::supports.
  int body = 0;                                       ///< Of the scene.
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    ///< Point of the surface, world, metres.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Of the surface there, world.
  double distance = 0.0;  ///< From the surface, metres; not 0 before and after the contact.
  double share = 0.0;     ///< Factor for the weights, 0 to 1.
  int phase = -1;         ///< Index of the contact.
  bool sticks = false;    ///< The contact does not slide.
  bool held = false;      ///< `place` is that of the robot (hold_contacts).
  /// For hands, the direction that faces the surface, in the link's frame; zero: none.
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
};

/// The world of a robot: the scaled scene, the points of the robot that must stay outside of it, and
/// the contacts with it. Immutable during a fit.
struct FitScene {
  SceneWorld world;                             ///< Frames of the fit, robot's world.
  std::vector<std::vector<FloorPoint>> points;  ///< Spheres that cover the shapes, by link.
  std::vector<BoundingSphere> spheres;          ///< By link, around its points.
  std::vector<SceneGoal> goals;                 ///< By frame.
  std::vector<std::uint32_t> first_goal;        ///< One per frame and one behind the last.

  [[nodiscard]] std::span<const SceneGoal> goals_of(int frame) const {
    const auto begin = first_goal[static_cast<std::size_t>(frame)];
    return std::span(goals).subspan(begin, first_goal[static_cast<std::size_t>(frame) + 1] - begin);
  }
};

/// Raises the smoothness of joints and of the root's position. Hands and feet that reach surfaces which
/// a robot of other proportions meets elsewhere than its human would otherwise arrive with jolts.
[[nodiscard]] FitOptions smoother_in_scene(FitOptions options);

/// Makes a robot's world from that of its human.
/// @param scale  from the human's to the robot's paths, and size of static bodies.
/// @param targets  frame-major, one per task of the model.
[[nodiscard]] FitScene make_fit_scene(const FitModel& model, const SceneWorld& human_world,
                                      const SurfaceParts& parts,
                                      std::span<const SurfacePhase> phases, double scale,
                                      double frame_time, std::span<const TaskTarget> targets);

/// Moves the positions of sticking contacts to their means in a solved clip, and holds them there. The
/// first solve follows the human's positions only loosely, because robots have other arms; the
/// second one holds these positions.
/// @param qpos  frame-major, laid out as in RobotClip.
/// @return whether there is any such contact.
bool hold_contacts(const FitModel& model, std::span<const double> qpos, FitScene& scene);

/// Costs of a frame's scene terms.
struct SceneCosts {
  double contact = 0.0, penetration = 0.0;
};

/// Adds the forms of a frame's scene terms to those of the links: contacts touch their surfaces, and
/// nothing penetrates any.
SceneCosts add_scene_terms(const FitModel& model, const FitOptions& options, const FitScene& scene,
                           int frame, const TreeState& pose, std::span<Composite> composites);

}  // namespace retarget
