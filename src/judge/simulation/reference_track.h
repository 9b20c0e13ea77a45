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

/// The horizontal state of the balance at one instant.
struct BalanceSample {
  /// Zero-moment point: the point of the floor about which a force has the required moment. Metres.
  Eigen::Vector2d zmp = Eigen::Vector2d::Zero();
  /// Points that bear load, metres; none in flight.
  std::vector<Eigen::Vector2d> support;
  /// Vertical force over mass times height of the centre of mass, 1/s^2; 0 in flight.
  double pull = 0.0;
};

/// The point of a support area that is nearest to a point: of the convex hull of `support`, shrunk
/// about its middle.
/// @param share  of the hull that remains, 0 to 1.
[[nodiscard]] Eigen::Vector2d nearest_in_support(const Eigen::Vector2d& point,
                                                 std::vector<Eigen::Vector2d> support,
                                                 double share);

/// Finds the shift x of the centre of mass with which the zero-moment point of every sample lies in
/// its support area: the bounded solution of
///
///     x'' = pull (x - d),   x(0) = x(end) = 0
///
/// where d is the shift of the zero-moment point into the support area. It is the linear inverted
/// pendulum with the future known: the body leans before it has to. In flight x is a straight line.
/// @param time_step  between two samples, seconds.
/// @return by sample, metres.
[[nodiscard]] std::vector<Eigen::Vector2d> balancing_shift(
    const std::vector<BalanceSample>& samples, double time_step, double share);

/// A foot of a robot: the link with the sole, and the middle of the sole.
struct FootFrame {
  int link = 0;
  Eigen::Vector3d in_link = Eigen::Vector3d::Zero();  ///< Metres.
};

/// One per link with a sole.
[[nodiscard]] std::vector<FootFrame> make_foot_frames(const Robot& robot);

/// Movement of a foot: pose of the middle of its sole, and its first two derivatives: linear, then
/// angular, world axes.
struct FootMotion {
  Pose pose;
  Vector6d velocity = Vector6d::Zero();
  Vector6d acceleration = Vector6d::Zero();
  bool planned = false;        ///< Whether a point of the sole is planned to bear on the floor.
  double until_planned = 0.0;  ///< Seconds until it is; infinity if it never is.
};

/// The reference of a controller at one instant. World axes, metres, seconds.
struct ReferenceState {
  explicit ReferenceState(const Robot& robot) : motion(robot) {}

  MotionState motion;
  Eigen::Vector3d com = Eigen::Vector3d::Zero(), com_velocity = com, com_acceleration = com;
  Eigen::Vector3d shift_velocity = com;  ///< Part of com_velocity that the motion does not have.
  /// Angular momentum about the centre of mass, kg m^2/s, and its rate.
  Eigen::Vector3d momentum = com, momentum_rate = com;
  std::vector<FootMotion> feet;  ///< By FootFrame.
  std::vector<char> planned;     ///< By support point: whether it is planned to bear on the floor.
};

/// A motion as a reference of a controller: the C2 spline through its frames (MotionSpline), sampled
/// at equal steps, with the centre of mass, the feet and the contacts. The floor, the height at which
/// soles stand in the motion, is moved to 0. The centre of mass is shifted so that the planned points
/// can bear it (balancing_shift).
class ReferenceTrack {
 public:
  /// @param steps_per_frame  samples between two frames.
  /// @param floor            height of the floor in the motion, metres.
  ReferenceTrack(const RobotClip& clip, int steps_per_frame, double floor);

  [[nodiscard]] int step_count() const { return step_count_; }
  [[nodiscard]] double time_step() const { return time_step_; }
  /// Computes a step. Steps must be requested in order.
  const ReferenceState& at(int step);

 private:
  // The part of a state that needs no neighbours; derivatives are differences of neighbouring ones.
  struct Sample {
    explicit Sample(const Robot& robot) : motion(robot) {}

    int step = -1;
    MotionState motion;
    Eigen::Vector3d com, com_acceleration, momentum;
    Wrench needed;  // About the centre of mass.
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
  std::vector<std::vector<double>> until_planned_;  // By foot and step; FootMotion.
  std::vector<Eigen::Vector2d> shift_;  // Of the centre of mass, by step; balancing_shift().
};

}  // namespace retarget
