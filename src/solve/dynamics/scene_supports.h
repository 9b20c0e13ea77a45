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

/// The mechanical effect of a scene's bodies on a robot. Static bodies, and moving bodies that rest
/// on the floor or on a static body, support the robot. Lifted bodies are loads of the links that
/// touch them.
class SceneSupports {
 public:
  /// @param world       scene around the robot, with at least one frame; must outlive this object.
  /// @param begin, end frames [begin, end) for which the object computes motions. Calls clamp their
  ///     frame to this range.
  SceneSupports(const SceneWorld& world, int begin, int end);

  /// Degree to which a body is lifted: 0 if it rests on the floor or on a static body, 1 if it is
  /// at least 4 cm above.
  [[nodiscard]] double lifted(int frame, std::size_t body) const {
    const BodyMotion* const moves = motion(frame, body);
    return moves == nullptr ? 0.0 : moves->lifted;
  }

  /// The nearest body of the scene that supports a sphere of the robot.
  /// @param centre    centre of the sphere, world, metres.
  /// @param radius    metres.
  /// @param velocity  velocity of the sphere, world, m/s.
  /// @param height    largest distance between the sphere and the body, metres.
  /// @param speed     largest speed of the sphere relative to the body, m/s.
  /// @return index of the body; empty if there is none.
  [[nodiscard]] std::optional<std::size_t> touched(int frame, const Eigen::Vector3d& centre,
                                                   double radius, const Eigen::Vector3d& velocity,
                                                   double height, double speed) const;
  /// Contact point of a sphere with a body.
  [[nodiscard]] ContactPlace place(int frame, const Eigen::Vector3d& centre, double radius,
                                   std::size_t body) const;

  /// Finds the forces that carry the lifted bodies. The links within `reach` (metres) of a body
  /// carry equal shares of its weight and inertial force. Ignores the body's rotation.
  /// @param points  points on the robot's surface.
  /// @param loads   overwritten with the forces.
  void find_loads(int frame, const std::vector<SupportPoint>& points, const TreeState& state,
                  double reach, std::vector<LinkLoad>& loads) const;

 private:
  // Motion of a moving body in one frame.
  struct BodyMotion {
    Eigen::Vector3d com = Eigen::Vector3d::Zero();       // Centre of mass, world, metres.
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // Of the centre of mass, m/s.
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();      // Angular velocity, world axes, rad/s.
    Eigen::Vector3d force = Eigen::Vector3d::Zero();     // Carrying force times `lifted`, N.
    double lifted = 0.0;                                 // See lifted().
  };
  [[nodiscard]] BodyMotion motion_of(int frame, std::size_t body) const;
  [[nodiscard]] const BodyMotion* motion(int frame, std::size_t body) const;
  [[nodiscard]] int inside(int frame) const;

  const SceneWorld& world_;
  int begin_, end_;
  std::vector<int> row_;             // One per body: index among the moving bodies; -1 if static.
  std::vector<BodyMotion> motions_;  // Frame-major, moving bodies only.
  std::size_t moving_ = 0;
};

}  // namespace retarget
