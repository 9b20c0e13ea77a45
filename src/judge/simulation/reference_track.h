#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/math/se3.h"
#include "judge/simulation/physics_model.h"
#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "solve/dynamics/inertias.h"
#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/motion_spline.h"
#include "solve/dynamics/support_points.h"

namespace retarget {

/// The state of the balance at one instant; world x and y.
struct BalanceSample {
  /// Zero-moment point, metres.
  Eigen::Vector2d zmp = Eigen::Vector2d::Zero();
  /// Points in contact, metres; empty in flight.
  std::vector<Eigen::Vector2d> support;
  /// Vertical force divided by mass and height of the centre of mass, 1/s^2; 0 in flight.
  double pull = 0.0;
};

/// The point of a shrunk support polygon that is nearest to a point.
/// @param support  points in contact; without points, the result is `point`.
/// @param share    scale of their convex hull about the mean of its corners, 0 to 1.
[[nodiscard]] Eigen::Vector2d nearest_in_support(const Eigen::Vector2d& point,
                                                 std::vector<Eigen::Vector2d> support,
                                                 double share);

/// Finds the shift x of the centre of mass with which the zero-moment point of every sample is in
/// its support polygon: the solution of
///
///     x'' = pull (x - d),   x(0) = x(end) = 0
///
/// where d is the shift of the zero-moment point to the nearest point of the polygon. This is the
/// linear inverted pendulum with preview: the body leans before the polygon requires it. In flight,
/// x is linear in time.
/// @param time_step  seconds between two samples.
/// @param share      see nearest_in_support().
/// @return x by sample, metres.
[[nodiscard]] std::vector<Eigen::Vector2d> balancing_shift(
    const std::vector<BalanceSample>& samples, double time_step, double share);

/// A frame at the middle of a robot's sole, with the axes of the link.
struct FootFrame {
  int link = 0;                                       ///< Link of Robot::tree().
  Eigen::Vector3d in_link = Eigen::Vector3d::Zero();  ///< Origin in the link frame, metres.
};

/// The foot frames of a robot, one per link with a sole.
[[nodiscard]] std::vector<FootFrame> make_foot_frames(const Robot& robot);

/// Motion of a FootFrame: its world pose and the two time derivatives, linear (m/s, m/s^2), then
/// angular (rad/s, rad/s^2), in world axes.
struct FootMotion {
  Pose pose;
  Vector6d velocity = Vector6d::Zero();
  Vector6d acceleration = Vector6d::Zero();
  bool planned = false;        ///< Whether a contact of the sole with the floor is planned.
  double until_planned = 0.0;  ///< Seconds until the next planned contact; infinity without one.
};

/// The reference of a controller at one instant. World axes, metres, seconds.
struct ReferenceState {
  explicit ReferenceState(const Robot& robot) : motion(robot) {}

  MotionState motion;
  Eigen::Vector3d com = Eigen::Vector3d::Zero(), com_velocity = com, com_acceleration = com;
  /// Part of com_velocity that comes from balancing_shift().
  Eigen::Vector3d shift_velocity = com;
  /// Angular momentum about the centre of mass, kg m^2/s, and its rate.
  Eigen::Vector3d momentum = com, momentum_rate = com;
  std::vector<FootMotion> feet;  ///< Motion of the feet, indexed by FootFrame.
  std::vector<char> planned;     ///< Whether a contact with the floor is planned, by support point.
};

/// A motion as the reference of a controller: the C2 spline through its frames (MotionSpline),
/// sampled at equal time steps, with the centre of mass, the feet and the contacts. The floor of
/// the motion is moved to height 0. The centre of mass is shifted so that the zero-moment point
/// stays in the support polygon of the planned contacts (balancing_shift()).
class ReferenceTrack {
 public:
  /// @param steps_per_frame  number of time steps per frame.
  /// @param floor            height of the floor in the motion, metres.
  ReferenceTrack(const RobotClip& clip, int steps_per_frame, double floor);

  [[nodiscard]] int step_count() const { return step_count_; }
  [[nodiscard]] double time_step() const { return time_step_; }  ///< Seconds.
  /// The state at a step, valid until the next call. Ascending steps reuse the neighbouring
  /// samples.
  const ReferenceState& at(int step);

 private:
  // The part of a state that does not depend on other steps. Central differences of samples give
  // the derivatives of the rest.
  struct Sample {
    explicit Sample(const Robot& robot) : motion(robot) {}

    int step = -1;
    MotionState motion;
    Eigen::Vector3d com, com_acceleration, momentum;
    Wrench needed;  // Required wrench about the centre of mass.
    std::vector<Pose> feet;
    std::vector<Eigen::Vector3d> points;
  };

  void preview_balance();
  [[nodiscard]] Eigen::Vector3d shift_at(int step) const;
  void sample(int step, Sample& into);
  void set_feet(const Sample& before, const Sample& now, const Sample& after);
  void set_planned(const Sample& before, const Sample& now, const Sample& after);
  bool plan_points(const Sample& before, const Sample& now, const Sample& after, double height,
                   double speed);
  void find_touchdowns(const std::vector<std::vector<char>>& planned);

  const Robot& robot_;
  MotionSpline spline_;
  Inertias inertias_;
  std::vector<SupportPoint> points_;
  std::vector<FootFrame> feet_;
  int steps_per_frame_, step_count_;
  double time_step_, floor_, size_;
  TreeState state_;
  InverseDynamics inverse_;
  std::array<Sample, 3> window_;  // The steps before, at and after the current one.
  ReferenceState reference_;
  std::vector<std::vector<double>> until_planned_;  // By foot and step; see FootMotion.
  std::vector<Eigen::Vector2d> shift_;  // One per step: balancing_shift() of the centre of mass.
};

}  // namespace retarget
