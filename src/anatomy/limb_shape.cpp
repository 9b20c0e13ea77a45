#include "anatomy/limb_shape.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "math/trigonometry.h"
#include "retarget/pose.h"
#include "robot/core_points.h"
#include "robot/limb_joints.h"
#include "robot/model_values.h"

namespace retarget {
namespace {

constexpr double kLeastShare = 0.05;       // of a limb: what is less is no segment
constexpr double kLeastLegSegment = 0.35;  // of thigh or shin: as kLeastSegment

// the part of a vector across a unit axis
Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis) {
  return vector - vector.dot(axis) * axis;
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
  return std::ranges::all_of(
      joints, [&](int joint) { return std::abs(posed.axis(joint).dot(direction)) > kTurnsAlong; });
}

struct Split {
  LimbShape shape;
  double score = 0.0;
};

// a toe: the last joint of a leg, which turns as the knee does and lies ahead of where the others
// beyond the knee meet
bool ends_in_toe(const TreeState& posed, const std::vector<int>& beyond,
                 const Eigen::Vector3d& knee, const Eigen::Vector3d& axis) {
  constexpr double kAhead = 0.12;  // of the shin
  constexpr double kAlike = 0.8;
  if (beyond.size() < 2 || posed.slides(beyond.back())) return false;
  const Eigen::Vector3d ankle = common_point(posed, std::span(beyond).first(beyond.size() - 1));
  const Eigen::Vector3d shin = across(ankle - knee, axis);
  const Eigen::Vector3d foot = across(posed.anchor(beyond.back()) - ankle, axis);
  const double along = foot.dot(shin.normalized());
  const double ahead = (foot - along * shin.normalized()).norm();
  return std::abs(posed.axis(beyond.back()).dot(axis)) > kAlike && ahead > std::abs(along) &&
         ahead > kAhead * shin.norm();
}

// where the joints beyond the middle meet, or what marks the end where none of them does
void find_end(const Robot& robot, const TreeState& posed, const std::vector<int>& beyond,
              double upper, bool is_leg, LimbShape& shape) {
  const int last = robot.joints()[shape.joints.back()].body;
  const Eigen::Vector3d& anchor = posed.anchor(shape.joints[shape.middle]);
  if (!beyond.empty()) {
    shape.at_end = joints_at_middle(posed, beyond, shape.bend);
    shape.end = common_point(posed, std::span(beyond).subspan(shape.at_end));
    // a joint that turns the forearm from its elbow marks no wrist
    const double marked = across(shape.end - anchor, shape.axis).norm();
    const double near = kLeastSegment * upper;
    if (is_leg || marked >= near || !all_pass(posed, beyond, shape.bend, near)) return;
  }
  const SegmentEnd end = segment_end(robot, posed, {last, shape.root, anchor, shape.axis, beyond});
  shape.end = end.point;
  shape.end_body = end.body;
  shape.end_is_estimated = end.estimated;
  // what bends the elbow once more, and not what turns the forearm
  const Eigen::Vector3d forearm = (shape.end - shape.bend).normalized();
  for (std::size_t i = 0; i < beyond.size(); ++i) {
    if (std::abs(posed.axis(beyond[i]).dot(forearm)) < kTurnsAlong) shape.at_end = i + 1;
  }
}

// how well the hinge at `middle` parts a chain: long segments, joints that meet in points
std::optional<Split> split_at(const Robot& robot, const TreeState& posed,
                              const std::vector<int>& chain, int middle, bool is_leg) {
  constexpr double kSlack = 0.1;
  std::vector<int> before(chain.begin(), chain.begin() + middle);
  std::vector<int> beyond(chain.begin() + middle + 1, chain.end());
  Split split;
  LimbShape& shape = split.shape;
  shape.joints = chain;
  shape.middle = middle;
  shape.axis = posed.axis(chain[middle]);
  const Eigen::Vector3d& anchor = posed.anchor(chain[middle]);
  if (is_leg && ends_in_toe(posed, beyond, anchor, shape.axis)) {
    shape.toe = beyond.back();
    shape.joints.pop_back();
    beyond.pop_back();
  }
  shape.root = common_point(posed, before);
  shape.bend = anchor + (shape.root - anchor).dot(shape.axis) * shape.axis;
  const std::vector<int> inwards(before.rbegin(), before.rend());
  shape.at_root = joints_at_middle(posed, inwards, shape.bend);
  before.resize(before.size() - shape.at_root);
  shape.root = common_point(posed, before);
  const double upper = across(anchor - shape.root, shape.axis).norm();
  find_end(robot, posed, beyond, upper, is_leg, shape);
  beyond.erase(beyond.begin(), beyond.begin() + static_cast<std::ptrdiff_t>(shape.at_end));
  const double lower = across(shape.end - anchor, shape.axis).norm();
  // a hinge along a limb, or at the end of it, bends nothing
  const double whole = (anchor - shape.root).norm() + (shape.end - anchor).norm();
  if (!(std::min(upper, lower) > kLeastShare * whole)) return std::nullopt;
  const double least = is_leg ? kLeastLegSegment : kLeastSegment;
  if (!(std::min(upper, lower) > least * std::max(upper, lower))) return std::nullopt;
  const double spread =
      spread_about(shape.root, posed, before) + spread_about(shape.end, posed, beyond);
  if (is_leg) {
    move_to_parallel_hinge(posed, before, shape.axis, shape.root);
    move_to_parallel_hinge(posed, beyond, shape.axis, shape.end);
  } else if (!beyond.empty() && all_turn_about(posed, beyond, (shape.end - anchor).normalized())) {
    const SegmentEnd end = segment_end(
        robot, posed, {robot.joints()[beyond.back()].body, shape.root, anchor, shape.axis, beyond});
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

// whether a joint is the middle one of a limb or bends it there as well
bool is_at_middle(const LimbShape& shape, int joint) {
  return joint >= shape.middle - static_cast<int>(shape.at_root) &&
         joint <= shape.middle + static_cast<int>(shape.at_end);
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
                                    const std::vector<int>& chain, bool is_leg,
                                    std::optional<int> at) {
  std::vector<Split> splits;
  for (int middle = 1; middle < static_cast<int>(chain.size()); ++middle) {
    if (at && middle != *at) continue;
    if (auto split = split_at(robot, posed, chain, middle, is_leg)) {
      splits.push_back(std::move(*split));
    }
  }
  if (splits.empty()) return std::nullopt;
  const Split* best = &*std::ranges::max_element(splits, {}, &Split::score);
  // of hinges at one knee or elbow the one that bends farther
  constexpr double kFarther = 1.2;
  constexpr double kAsClear = 0.5;
  const auto bends_by = [&](const Split& split) {
    const int joint = chain[split.shape.middle];
    return robot.model_limits().upper[joint] - robot.model_limits().lower[joint];
  };
  const LimbShape group = best->shape;
  for (const Split& split : splits) {
    if (is_at_middle(group, split.shape.middle) && split.score > kAsClear * best->score &&
        bends_by(split) > kFarther * bends_by(*best)) {
      best = &split;
    }
  }
  // what follows a whole wrist is a gripper
  constexpr std::size_t kWrist = 3;
  const std::size_t whole = best->shape.middle + best->shape.at_end + 1 + kWrist;
  if (!is_leg && chain.size() > whole) {
    auto shorter = shape_limb(robot, posed, reference, {chain.begin(), chain.begin() + whole},
                              is_leg, best->shape.middle);
    if (shorter) return shorter;
  }
  double second = 0.0;
  for (const Split& split : splits) {
    if (!is_at_middle(group, split.shape.middle)) second = std::max(second, split.score);
  }
  LimbShape shape = best->shape;
  shape.clarity = 1.0 - second / best->score;
  find_flexion(robot, reference, shape);
  return shape;
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
