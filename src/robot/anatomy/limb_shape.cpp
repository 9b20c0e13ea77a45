#include "robot/anatomy/limb_shape.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "retarget/pose.h"
#include "retarget/shape_distance.h"
#include "retarget/trigonometry.h"
#include "robot/model/limb_joints.h"
#include "robot/model/model_values.h"

namespace retarget {
namespace {

constexpr double kLeastShare = 0.05;  // Fraction of the limb: anything shorter is not a segment.
constexpr double kLeastLegSegment = 0.35;  // Fraction of thigh or shin, used like kLeastSegment.
constexpr std::size_t kWristJoints = 3;

// Returns the root mean square distance of a point from joint axes.
double spread_about(const Eigen::Vector3d& point, const TreeState& posed,
                    const std::vector<int>& joints) {
  double sum = 0.0;
  for (const int joint : joints) {
    sum += (point - posed.anchor(joint)).cross(posed.axis(joint)).squaredNorm();
  }
  return joints.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(joints.size()));
}

// Returns the hinge most parallel to an axis; nothing if none is close to parallel.
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

// Moves a point to the nearest point on the axis of the hinge that bends the same way.
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

// Groups joints by position, in their order.
std::vector<std::vector<int>> places_of(const TreeState& posed, std::span<const int> joints,
                                        double within) {
  std::vector<std::vector<int>> places;
  for (const int joint : joints) {
    if (places.empty() ||
        (posed.anchor(joint) - posed.anchor(places.back().front())).norm() > within) {
      places.emplace_back();
    }
    places.back().push_back(joint);
  }
  return places;
}

// Returns true if joints at one position bend the foot ahead of its ankle.
// @param lateral  the axis about which feet bend.
bool are_toes(const TreeState& posed, const std::vector<int>& joints, std::span<const int> inner,
              const Eigen::Vector3d& knee, const Eigen::Vector3d& lateral) {
  constexpr std::size_t kMost = 3;
  constexpr double kAhead = 0.12;  // Fraction of the shin.
  constexpr double kNear = 0.25;   // Fraction of the shin: joints this close make one ankle.
  constexpr double kAlike = 0.8;
  const Eigen::Vector3d& last = posed.anchor(inner.back());
  std::size_t count = 0;
  while (count < std::min(kMost, inner.size()) &&
         (posed.anchor(inner[inner.size() - 1 - count]) - last).norm() <=
             kNear * (last - knee).norm()) {
    ++count;
  }
  const Eigen::Vector3d ankle = common_point(posed, inner.last(count));
  const Eigen::Vector3d shin = across(ankle - knee, lateral);
  const Eigen::Vector3d foot = across(posed.anchor(joints.front()) - ankle, lateral);
  const double along = foot.dot(shin.normalized());
  const double ahead = (foot - along * shin.normalized()).norm();
  const bool turn = std::ranges::none_of(joints, [&](int joint) { return posed.slides(joint); });
  const bool bend = std::ranges::any_of(
      joints, [&](int joint) { return std::abs(posed.axis(joint).dot(lateral)) > kAlike; });
  return joints.size() <= kMost && turn && bend && ahead > std::abs(along) &&
         ahead > kAhead * shin.norm();
}

// Counts the toe joints at the end of a leg: the first place ahead of the ankle, and those beyond
// it.
std::size_t toe_joints(const TreeState& posed, const std::vector<int>& beyond,
                       const Eigen::Vector3d& knee, const Eigen::Vector3d& lateral) {
  constexpr double kOnePlace = 0.05;  // Fraction of the distance from knee to toe.
  if (beyond.empty()) return 0;
  const double within = kOnePlace * (posed.anchor(beyond.back()) - knee).norm();
  std::size_t at_knee = 0;
  while (at_knee < beyond.size() && (posed.anchor(beyond[at_knee]) - knee).norm() <= within) {
    ++at_knee;
  }
  const std::span<const int> below = std::span(beyond).subspan(at_knee);
  std::size_t inner = 0;
  for (const std::vector<int>& place : places_of(posed, below, within)) {
    if (inner > 0 && are_toes(posed, place, below.first(inner), knee, lateral)) {
      return below.size() - inner;
    }
    inner += place.size();
  }
  return 0;
}

// Sets the limb's end: the intersection of the joints beyond the middle, otherwise segment_end.
void find_end(const Robot& robot, const TreeState& posed, const std::vector<int>& beyond,
              double upper, bool is_leg, LimbShape& shape) {
  const int last = robot.joints()[shape.joints.back()].body;
  const Eigen::Vector3d& anchor = posed.anchor(shape.joints[shape.middle]);
  if (!beyond.empty()) {
    shape.at_end = joints_at_middle(posed, beyond, shape.bend);
    shape.end = common_point(posed, std::span(beyond).subspan(shape.at_end));
    // A joint near the elbow that twists the forearm does not mark a wrist.
    const double marked = across(shape.end - anchor, shape.axis).norm();
    if (is_leg || marked >= kNearestWrist * upper ||
        !all_pass(posed, beyond, shape.bend, kLeastSegment * upper)) {
      return;
    }
  }
  const SegmentEnd end = segment_end(robot, posed, {last, shape.root, anchor, shape.axis, beyond});
  shape.end = end.point;
  shape.end_body = end.body;
  shape.end_is_estimated = end.estimated;
  // Count joints that bend the elbow again, not joints that twist the forearm.
  const Eigen::Vector3d forearm = (shape.end - shape.bend).normalized();
  for (std::size_t i = 0; i < beyond.size(); ++i) {
    if (std::abs(posed.axis(beyond[i]).dot(forearm)) < kTurnsAlong) shape.at_end = i + 1;
  }
}

// The limb that is split.
struct LimbChain {
  const Robot& robot;
  const TreeState& posed;
  bool is_leg = false;
  const Eigen::Vector3d& forward;  // The facing direction, or its opposite.
};

// Scores how well the hinge at `middle` splits a chain: long segments, joint axes that intersect.
std::optional<Split> split_at(const LimbChain& limb, const std::vector<int>& chain, int middle) {
  const auto& [robot, posed, is_leg, forward] = limb;
  constexpr double kSlack = 0.1;
  std::vector<int> before(chain.begin(), chain.begin() + middle);
  std::vector<int> beyond(chain.begin() + middle + 1, chain.end());
  Split split;
  LimbShape& shape = split.shape;
  shape.joints = chain;
  shape.middle = middle;
  shape.axis = posed.axis(chain[middle]);
  const Eigen::Vector3d& anchor = posed.anchor(chain[middle]);
  const Eigen::Vector3d lateral = Eigen::Vector3d::UnitZ().cross(forward);
  if (const std::size_t toes = is_leg ? toe_joints(posed, beyond, anchor, lateral) : 0; toes > 0) {
    shape.toe = beyond[beyond.size() - toes];
    shape.joints.resize(shape.joints.size() - toes);
    beyond.resize(beyond.size() - toes);
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
  // A hinge parallel to the limb or at its end does not bend it.
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
  // A joint that twists the limb lies along the line from its root to its end.
  const Eigen::Vector3d line = (shape.end - shape.root).normalized();
  const double perpendicular = std::max(shape.axis.cross(line).norm(), kLeastShare);
  // The bend is level with the limb's end along the middle axis; the root may be offset sideways.
  shape.bend = anchor + (shape.end - anchor).dot(shape.axis) * shape.axis;
  shape.root += (shape.end - shape.root).dot(shape.axis) * shape.axis;
  split.score = std::min(upper, lower) / (spread + kSlack * (upper + lower)) * perpendicular *
                plausibility(robot, {chain, middle, static_cast<int>(before.size()), is_leg});
  return split;
}

// Adds a full turn to an angle if that brings it closer to a range.
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

// Returns true if a joint is the middle joint or bends the limb at the same place.
bool is_at_middle(const LimbShape& shape, int joint) {
  return joint >= shape.middle - static_cast<int>(shape.at_root) &&
         joint <= shape.middle + static_cast<int>(shape.at_end);
}

// Returns all candidates for the knee or elbow. Hands may add joints beyond the wrist, so arms are
// also split with at most a full wrist beyond the elbow.
std::vector<Split> splits_of(const LimbChain& limb, const std::vector<int>& chain,
                             std::optional<int> at) {
  constexpr double kClearly = 1.0 + 1e-6;  // Rounding must not distinguish left and right.
  std::vector<Split> splits;
  const int count = static_cast<int>(chain.size());
  for (int middle = 1; middle < count; ++middle) {
    if (at && middle != *at) continue;
    auto split = split_at(limb, chain, middle);
    const int whole = middle + 1 + static_cast<int>(kWristJoints);
    if (!limb.is_leg && count > whole) {
      auto shorter = split_at(limb, {chain.begin(), chain.begin() + whole}, middle);
      if (shorter && (!split || shorter->score > kClearly * split->score))
        split = std::move(shorter);
    }
    if (split) splits.push_back(std::move(*split));
  }
  return splits;
}

// Names decide between joints that fit nearly equally well.
const Split& best_named(const Robot& robot, const std::vector<Split>& splits, const Split& best,
                        bool is_leg) {
  constexpr double kNearlyAsWell = 0.7;
  const auto vote = [&](const Split& split) {
    return middle_vote_of_names(robot, split.shape.joints[split.shape.middle], is_leg);
  };
  const Split* named = &best;
  for (const Split& split : splits) {
    if (split.score > kNearlyAsWell * best.score && vote(split) > vote(*named)) named = &split;
  }
  return *named;
}

// Among hinges at one knee or elbow, prefers the one with the larger range; on similar ranges, as
// in a three-hinge joint, the one that bends the limb forwards or backwards. Legs do not bend
// sideways.
const Split& farthest_bending(const Robot& robot, const std::vector<Split>& splits,
                              const Split& best, bool is_leg, const Eigen::Vector3d& forward) {
  constexpr double kFarther = 1.2;
  constexpr double kAsClear = 0.5;
  constexpr double kAlike = 0.95;
  constexpr double kStraighter = 0.3;
  const auto bends_by = [&](const Split& split) {
    const int joint = split.shape.joints[split.shape.middle];
    return robot.model_limits().upper[joint] - robot.model_limits().lower[joint];
  };
  const auto to_front = [&](const Split& split) {
    return std::abs(split.shape.axis.cross(split.shape.lower()).dot(forward));
  };
  const Split* chosen = &best;
  for (const Split& split : splits) {
    if (!is_at_middle(best.shape, split.shape.middle)) continue;
    const bool farther =
        split.score > kAsClear * best.score && bends_by(split) > kFarther * bends_by(*chosen);
    const bool straighter = split.score > (is_leg ? kAsClear : kAlike) * best.score &&
                            bends_by(split) > kAlike * bends_by(*chosen) &&
                            to_front(split) > to_front(*chosen) + kStraighter;
    if (farther || straighter) chosen = &split;
  }
  return *chosen;
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
                                    const Eigen::Vector3d& forward, std::optional<int> at) {
  const LimbChain limb{robot, posed, is_leg, forward};
  const std::vector<Split> splits = splits_of(limb, chain, at);
  if (splits.empty()) return std::nullopt;
  const Split& geometric = *std::ranges::max_element(splits, {}, &Split::score);
  const Split& named = best_named(robot, splits, geometric, is_leg);
  const Split& best = farthest_bending(robot, splits, named, is_leg, forward);
  double second = 0.0;
  for (const Split& split : splits) {
    if (!is_at_middle(named.shape, split.shape.middle)) second = std::max(second, split.score);
  }
  LimbShape shape = best.shape;
  // Joints beyond a full wrist belong to a gripper.
  const std::size_t whole = shape.middle + shape.at_end + 1 + kWristJoints;
  if (!is_leg && shape.joints.size() > whole) {
    const std::vector<int> shorter(chain.begin(), chain.begin() + whole);
    if (auto split = split_at(limb, shorter, shape.middle)) shape = split->shape;
  }
  shape.clarity = 1.0 - second / std::max(best.score, second);
  shape.scores.assign(chain.size(), 0.0);
  for (const Split& split : splits) shape.scores[split.shape.middle] = split.score;
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
