#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "scene/scene_world.h"
#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/support_points.h"

namespace retarget {

/// The effect of the bodies of a scene on a robot: they support it, or it carries them. A moving
/// body that rests on the floor or on a static body supports the robot; one that is lifted is a
/// load for the links that touch it.
class SceneSupports {
 public:
  /// @param world  around the robot; must outlive this object. It has at least one frame.
  /// @param begin, end  frames [begin, end) that the calls may name.
  SceneSupports(const SceneWorld& world, int begin, int end);

  /// From 0, for a body that rests on the floor or a static body, to 1, for one that is 4 cm above.
  [[nodiscard]] double lifted(int frame, std::size_t body) const {
    const BodyMotion* const moves = motion(frame, body);
    return moves == nullptr ? 0.0 : moves->lifted;
  }

  /// The nearest body of the scene that supports a ball of the robot.
  /// @param centre    world, metres.
  /// @param velocity  of the ball, world, m/s.
  /// @param height    largest distance between the ball and the body, metres.
  /// @param speed     largest speed of the ball relative to the body, m/s.
  /// @return index of the body; nothing if there is none.
  [[nodiscard]] std::optional<std::size_t> touched(int frame, const Eigen::Vector3d& centre,
                                                   double radius, const Eigen::Vector3d& velocity,
                                                   double height, double speed) const;
  /// Contact point of a ball with a body.
  [[nodiscard]] ContactPlace place(int frame, const Eigen::Vector3d& centre, double radius,
                                   std::size_t body) const;

  /// Finds the forces that carry the lifted bodies. Links within `reach` of a body share its weight
  /// and inertia equally; its rotation is ignored.
  /// @param points  of the robot.
  /// @param loads   receives the forces.
  void find_loads(int frame, const std::vector<SupportPoint>& points, const TreeState& state,
                  double reach, std::vector<LinkLoad>& loads) const;

 private:
  // Motion of a moving body in one frame.
  struct BodyMotion {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // Of its origin, m/s.
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();      // Angular velocity, world axes, rad/s.
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     // That carries its lifted share, N.
    double lifted = 0.0;                                 // From 0, rests, to 1.
  };
  [[nodiscard]] BodyMotion motion_of(int frame, std::size_t body) const;
  [[nodiscard]] const BodyMotion* motion(int frame, std::size_t body) const;
  [[nodiscard]] int inside(int frame) const;

  const SceneWorld& world_;
  int begin_, end_;
  std::vector<int> row_;             // By body: index among the moving ones; -1 if static.
  std::vector<BodyMotion> motions_;  // Frame-major, moving bodies only.
  std::size_t moving_ = 0;
};

}  // namespace retarget
