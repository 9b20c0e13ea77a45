// Finds the flat underside of a foot that is not level in the zero configuration.

#include "robot/anatomy/underside.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/math/convex_hull.h"
#include "retarget/pose.h"
#include "retarget/shape_distance.h"
#include "retarget/so3.h"
#include "robot/model/model_values.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// The part of a foot that touches a plane.
struct Footprint {
  double length = 0.0, width = 0.0;  // Along the axes forward and right.
  double area = 0.0;
};

double area_of(std::vector<Eigen::Vector2d> points) {
  reduce_to_hull(points);
  double twice = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d &a = points[i], &b = points[(i + 1) % points.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

double height_of(const FootBall& ball, const Vector3d& up) {
  return ball.centre.dot(up) - ball.radius;
}

class UndersideFinder {
 public:
  UndersideFinder(std::vector<FootBall> balls, const Eigen::Matrix3d& axes, double leg_length)
      : balls_(std::move(balls)), axes_(axes), leg_length_(leg_length) {}

  [[nodiscard]] Eigen::Quaterniond tilt() const;

 private:
  [[nodiscard]] Footprint footprint(const Eigen::Quaterniond& tilt) const;
  [[nodiscard]] std::optional<Vector3d> normal(const FootBall& a, const FootBall& b,
                                               const FootBall& c) const;
  [[nodiscard]] bool carries_all(const FootBall& ball, const Vector3d& up) const;
  [[nodiscard]] Eigen::Quaterniond tilt_to(const Vector3d& up) const {
    return rotation_between(axes_.col(1), up).normalized();
  }

  const std::vector<FootBall> balls_;
  const Eigen::Matrix3d& axes_;
  const double leg_length_;
};

Footprint UndersideFinder::footprint(const Eigen::Quaterniond& tilt) const {
  const Eigen::Matrix3d axes = tilt.toRotationMatrix() * axes_;
  double lowest = INFINITY;
  for (const FootBall& ball : balls_) lowest = std::min(lowest, height_of(ball, axes.col(1)));
  Vector3d lower = Vector3d::Constant(INFINITY), upper = -lower;
  std::vector<Eigen::Vector2d> touching;
  for (const FootBall& ball : balls_) {
    if (height_of(ball, axes.col(1)) > lowest + kSoleLayer * leg_length_) continue;
    const Vector3d local = axes.transpose() * ball.centre;
    lower = lower.cwiseMin(local);
    upper = upper.cwiseMax(local);
    touching.emplace_back(local.x(), local.z());
  }
  return {upper.x() - lower.x(), upper.z() - lower.z(), area_of(std::move(touching))};
}

// Returns the upward normal of the plane below three balls; nothing if they are in line, or if the
// plane is steep.
std::optional<Vector3d> UndersideFinder::normal(const FootBall& a, const FootBall& b,
                                                const FootBall& c) const {
  constexpr int kRounds = 4;  // The points of contact depend on the normal.
  constexpr double kLine = 1e-3;
  constexpr double kSteep = 0.7;  // Cosine.
  Vector3d up = axes_.col(1);
  for (int i = 0; i < kRounds; ++i) {
    const Vector3d first = b.centre - a.centre - (b.radius - a.radius) * up;
    const Vector3d second = c.centre - a.centre - (c.radius - a.radius) * up;
    const Vector3d across = first.cross(second);
    if (!(across.norm() > kLine * first.norm() * second.norm())) return std::nullopt;
    up = (across.dot(axes_.col(1)) < 0.0 ? -across : across).normalized();
  }
  return up.dot(axes_.col(1)) > kSteep ? std::optional(up) : std::nullopt;
}

bool UndersideFinder::carries_all(const FootBall& ball, const Vector3d& up) const {
  constexpr double kBelow = 1e-4;  // Fraction of the leg's length.
  const double height = height_of(ball, up) - kBelow * leg_length_;
  return std::ranges::all_of(balls_,
                             [&](const FootBall& other) { return height_of(other, up) >= height; });
}

Eigen::Quaterniond UndersideFinder::tilt() const {
  constexpr double kLeastWidth = 0.02;  // Fraction of the leg's length.
  constexpr double kFilled = 0.6;       // A sole is wide at both ends.
  constexpr double kClearly = 1.2;      // Fraction of the area that touches as the foot stands.
  const Eigen::Quaterniond none = Eigen::Quaterniond::Identity();
  const Footprint level = footprint(none);
  if (std::min(level.length, level.width) > kLeastSole * leg_length_) return none;
  std::optional<Vector3d> best;
  double largest = kClearly * level.area;
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    for (std::size_t j = i + 1; j < balls_.size(); ++j) {
      for (std::size_t k = j + 1; k < balls_.size(); ++k) {
        const auto up = normal(balls_[i], balls_[j], balls_[k]);
        if (!up || !carries_all(balls_[i], *up)) continue;
        const Footprint print = footprint(tilt_to(*up));
        const bool is_sole = print.length > kLeastSole * leg_length_ &&
                             print.width > kLeastWidth * leg_length_ &&
                             print.area > kFilled * print.length * print.width;
        if (!is_sole || print.area <= largest) continue;
        largest = print.area;
        best = up;
      }
    }
  }
  return best ? tilt_to(*best) : none;
}

}  // namespace

std::vector<CollisionShape> contact_shapes(const Robot& robot) {
  std::vector<CollisionShape> shapes = robot.collision_shapes();
  const mjModel* model = robot.model();
  for (int g = 0; g < model->ngeom; ++g) {
    const bool touches = model->geom_contype[g] != 0 || model->geom_conaffinity[g] != 0;
    const int body = model->geom_bodyid[g];
    const bool of_robot = model->body_rootid[body] == robot.root_body();
    if (!touches || !of_robot || model->geom_type[g] != mjGEOM_CYLINDER) continue;
    CollisionShape capsule;
    capsule.type = CollisionShape::Type::kCapsule;
    capsule.body = body;
    capsule.radius = model->geom_size[3 * g];
    capsule.half_length = std::max(model->geom_size[3 * g + 1] - capsule.radius, 0.0);
    if (capsule.half_length == 0.0) capsule.type = CollisionShape::Type::kSphere;
    capsule.body_from_shape = pose_at(model->geom_pos, model->geom_quat, g);
    shapes.push_back(capsule);
  }
  return shapes;
}

std::vector<FootBall> foot_balls(const std::vector<CollisionShape>& shapes, const TreeState& posed,
                                 int foot) {
  std::vector<FootBall> balls;
  const Pose foot_from_world = posed.world_from_body(foot).inverse();
  for (const int part : posed.tree->rigid_group(foot)) {
    const Pose foot_from_part = foot_from_world * posed.world_from_body(part);
    for (const CollisionShape& shape : shapes) {
      if (shape.body != part) continue;
      for (const Vector3d& point : core_points(shape)) {
        balls.push_back({foot_from_part * point, shape.radius});
      }
    }
  }
  return balls;
}

Eigen::Quaterniond foot_tilt(std::vector<FootBall> balls, const Eigen::Matrix3d& axes,
                             double leg_length) {
  constexpr std::size_t kMost = 96;  // All triples are tried.
  if (balls.size() > kMost) {
    std::ranges::nth_element(balls, balls.begin() + kMost, {},
                             [&](const FootBall& ball) { return height_of(ball, axes.col(1)); });
    balls.resize(kMost);
  }
  return UndersideFinder(std::move(balls), axes, leg_length).tilt();
}

}  // namespace retarget
