#include "anatomy/limb_shape.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/trigonometry.h"
#include "retarget/pose.h"
#include "robot/core_points.h"
#include "robot/model_values.h"

namespace retarget {
namespace {

// the part of a vector across a unit axis
Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis) {
  return vector - vector.dot(axis) * axis;
}

struct LimbEnd {
  Eigen::Vector3d point;
  std::optional<int> body;
  bool estimated = false;
};

Eigen::Vector3d centre_of_mass(const mjModel& model, const TreeState& posed, int body) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double mass = 0.0;
  for (const int part : posed.tree->rigid_group(body)) {
    sum += model.body_mass[part] * (posed.world_from_body(part) * vector_at(model.body_ipos, part));
    mass += model.body_mass[part];
  }
  return mass > 0.0 ? Eigen::Vector3d(sum / mass) : posed.world_from_body(body).translation;
}

// root mean square distance of a point from the axes of joints
double spread_about(const Eigen::Vector3d& point, const TreeState& posed,
                    const std::vector<int>& joints) {
  double sum = 0.0;
  for (const int joint : joints) {
    sum += (point - posed.anchor(joint)).cross(posed.axis(joint)).squaredNorm();
  }
  return joints.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(joints.size()));
}

bool carries_another(const Robot& robot, int body) {
  return std::ranges::any_of(robot.bodies(), [&](const RobotBody& b) { return b.parent == body; });
}

// where a limb ends whose last joint is its middle one: the farthest body fixed to it, else beyond
// its centre of mass, which lies near the middle of a segment
LimbEnd end_of_segment(const Robot& robot, const TreeState& posed, int body,
                       const Eigen::Vector3d& middle, const Eigen::Vector3d& axis,
                       double upper_length) {
  constexpr double kFarEnough = 0.35;
  constexpr double kBeyondMass = 2.0;
  LimbEnd end;
  end.point = middle;
  double farthest = kFarEnough * upper_length;
  for (const int part : posed.tree->rigid_group(body)) {
    const Eigen::Vector3d place = posed.world_from_body(part).translation;
    const double distance = across(place - middle, axis).norm();
    if (part == body || distance <= farthest || carries_another(robot, part)) continue;
    farthest = distance;
    end.point = place;
    end.body = part;
  }
  if (end.body) return end;
  end.estimated = true;
  const Eigen::Vector3d mass = across(centre_of_mass(*robot.model(), posed, body) - middle, axis);
  end.point = middle + kBeyondMass * mass;
  return end;
}

// the hinge whose axis is most like another one; none when they are far from parallel
std::optional<int> parallel_hinge(const TreeState& posed, const std::vector<int>& joints,
                                  const Eigen::Vector3d& axis) {
  std::optional<int> best;
  double max = 0.7;
  for (const int joint : joints) {
    const double alike = std::abs(posed.axis(joint).dot(axis));
    if (posed.slides(joint) || alike <= max) continue;
    max = alike;
    best = joint;
  }
  return best;
}

// moves a point to the nearest one on the axis of the hinge that bends the same way
void move_to_parallel_hinge(const TreeState& posed, const std::vector<int>& joints,
                            const Eigen::Vector3d& axis, Eigen::Vector3d& point) {
  const auto hinge = parallel_hinge(posed, joints, axis);
  if (!hinge) return;
  const Eigen::Vector3d& anchor = posed.anchor(*hinge);
  const Eigen::Vector3d& along = posed.axis(*hinge);
  point = anchor + (point - anchor).dot(along) * along;
}

bool all_turn_about(const TreeState& posed, const std::vector<int>& joints,
                    const Eigen::Vector3d& direction) {
  constexpr double kNearlyAlong = 0.9;
  return std::ranges::all_of(
      joints, [&](int joint) { return std::abs(posed.axis(joint).dot(direction)) > kNearlyAlong; });
}

struct Split {
  LimbShape shape;
  double score = 0.0;
};

// how well the hinge at `middle` parts a chain: long segments, joints that meet in points
std::optional<Split> split_at(const Robot& robot, const TreeState& posed,
                              const std::vector<int>& chain, int middle, bool is_leg) {
  constexpr double kSlack = 0.1;
  const std::vector<int> before(chain.begin(), chain.begin() + middle);
  const std::vector<int> beyond(chain.begin() + middle + 1, chain.end());
  Split split;
  LimbShape& shape = split.shape;
  shape.joints = chain;
  shape.middle = middle;
  shape.axis = posed.axis(chain[middle]);
  shape.root = common_point(posed, before);
  const Eigen::Vector3d& anchor = posed.anchor(chain[middle]);
  const double upper = across(anchor - shape.root, shape.axis).norm();
  if (beyond.empty()) {
    const LimbEnd end =
        end_of_segment(robot, posed, robot.joints()[chain[middle]].body, anchor, shape.axis, upper);
    shape.end = end.point;
    shape.end_body = end.body;
    shape.end_is_estimated = end.estimated;
  } else {
    shape.end = common_point(posed, beyond);
  }
  const double lower = across(shape.end - anchor, shape.axis).norm();
  if (!(std::min(upper, lower) > 0.0)) return std::nullopt;
  const double spread =
      spread_about(shape.root, posed, before) + spread_about(shape.end, posed, beyond);
  if (is_leg) {
    move_to_parallel_hinge(posed, before, shape.axis, shape.root);
    move_to_parallel_hinge(posed, beyond, shape.axis, shape.end);
  } else if (!beyond.empty() && all_turn_about(posed, beyond, (shape.end - anchor).normalized())) {
    const LimbEnd end =
        end_of_segment(robot, posed, robot.joints()[beyond.back()].body, anchor, shape.axis, upper);
    if (end.body) shape.end = end.point;
  }
  // the limb's line passes through its end; what turns at its root may stand beside it
  shape.bend = anchor + (shape.end - anchor).dot(shape.axis) * shape.axis;
  shape.root += (shape.end - shape.root).dot(shape.axis) * shape.axis;
  split.score = std::min(upper, lower) / (spread + kSlack * (upper + lower));
  return split;
}

// the whole turn of an angle that is nearest to a range
double nearest_turn(double angle, double lower, double upper) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double best = angle;
  double min = INFINITY;
  for (const int turns : {0, -1, 1}) {
    const double candidate = angle + turns * kTurn;
    const double outside = std::max({lower - candidate, candidate - upper, 0.0});
    if (outside < min) {
      min = outside;
      best = candidate;
    }
  }
  return best;
}

void find_flexion(const Robot& robot, const std::vector<double>& reference, LimbShape& shape) {
  constexpr double kClearly = 1.25;
  const int joint = shape.joints[shape.middle];
  const double lower = robot.model_limits().lower[joint];
  const double upper = robot.model_limits().upper[joint];
  const Eigen::Vector3d from = shape.upper();
  const Eigen::Vector3d to = shape.lower();
  const double angle = portable::atan2(from.cross(to).dot(shape.axis), from.dot(to));
  const double position = reference[robot.joints()[joint].qpos_address];
  shape.straight = nearest_turn(position - angle, lower, upper);
  const double above = upper - shape.straight;
  const double below = shape.straight - lower;
  if (above > kClearly * std::max(below, 0.0)) shape.flexion = 1.0;
  if (below > kClearly * std::max(above, 0.0)) shape.flexion = -1.0;
}

}  // namespace

Eigen::Vector3d LimbShape::upper() const {
  return across(bend - root, axis).normalized();
}

Eigen::Vector3d LimbShape::lower() const {
  return across(end - bend, axis).normalized();
}

std::optional<LimbShape> shape_limb(const Robot& robot, const TreeState& posed,
                                    const std::vector<double>& reference,
                                    const std::vector<int>& chain, bool is_leg) {
  std::optional<Split> best;
  double second = 0.0;
  for (int middle = 1; middle < static_cast<int>(chain.size()); ++middle) {
    const auto split = split_at(robot, posed, chain, middle, is_leg);
    if (!split) continue;
    if (best && split->score <= best->score) {
      second = std::max(second, split->score);
      continue;
    }
    if (best) second = best->score;
    best = split;
  }
  if (!best) return std::nullopt;
  best->shape.clarity = 1.0 - second / best->score;
  find_flexion(robot, reference, best->shape);
  return best->shape;
}

std::vector<Eigen::Vector3d> outline_points(const Robot& robot, const TreeState& posed, int body) {
  const mjModel* model = robot.model();
  std::vector<Eigen::Vector3d> points;
  for (const int part : posed.tree->rigid_group(body)) {
    const Pose world_from_part = posed.world_from_body(part);
    points.push_back(world_from_part.translation);
    for (int g = model->body_geomadr[part];
         g >= 0 && g < model->body_geomadr[part] + model->body_geomnum[part]; ++g) {
      const Pose world_from_geom = world_from_part * pose_at(model->geom_pos, model->geom_quat, g);
      const Eigen::Vector3d centre = vector_at(model->geom_aabb, 2 * g);
      const Eigen::Vector3d half_size = vector_at(model->geom_aabb, 2 * g + 1);
      for (const Eigen::Vector3d& corner : box_corners(half_size)) {
        points.push_back(world_from_geom * (centre + corner));
      }
    }
  }
  return points;
}

}  // namespace retarget
