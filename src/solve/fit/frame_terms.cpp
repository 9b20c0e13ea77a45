#include "solve/fit/frame_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "retarget/pose.h"
#include "retarget/shape_distance.h"
#include "solve/fit/one_sided.h"
#include "solve/fit/scene_terms.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/task_terms.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Lateral slope of a foot up to which its centre line is its lowest line; beyond it, an edge is.
constexpr double kLevelLean = 0.1;
// Half-width of the band around the floor margin over which the floor term's curvature grows to its
// full value, metres.
constexpr double kSoleBand = 0.001, kBodyBand = 0.003;

ShapeDistance distance_of(const TreeState& pose, const FitShape& a, const FitShape& b) {
  const auto in_world = [&](const FitShape& shape) {
    return placed(shape, pose.world_from_link[at(shape.link)]);
  };
  return shape_distance(in_world(a), in_world(b), NearestPoints::kEven);
}

// Whether an end of a foot is in contact.
bool in_contact(const FrameGoals& goals, std::size_t foot) {
  return std::ranges::any_of(goals.ends.subspan(2 * foot, 2),
                             [](const FootEndGoal& end) { return end.phase >= 0; });
}

// Degree to which a foot lies on the floor, 0 to 1. It is non-zero only if the foot is in contact
// and the contact prescribes the height of neither end.
double lying_share(const FrameGoals& goals, std::size_t foot) {
  const auto ends = goals.ends.subspan(2 * foot, 2);
  const bool level = std::ranges::any_of(ends, [](const auto& end) { return end.level; });
  return in_contact(goals, foot) && !level ? 1.0 - goals.upright[foot] : 0.0;
}

}  // namespace

FrameTerms::FrameTerms(const FitModel& model, const FitOptions& options)
    : model_(model),
      options_(options),
      composites_(model.tree.links().size()),
      tree_hessian_(at(model.tree.row_begin().back())),
      row_(at(model.dof_count()), 0.0),
      stands_(model.feet.size()),
      near_pairs_(model) {
  row_dofs_.reserve(row_.size());
  std::size_t most_points = 0;
  for (const SupportBody& body : model.supports) {
    most_points = std::max(most_points, body.points.size());
  }
  touches_.reserve(most_points);
}

// Adds the residual r of world coordinate `axis` of a point of a link. Its rate is n.(v + w x d),
// where n is the axis, d is `from_root`, the vector from the root's origin to the point, w is the
// link's angular velocity, and v is the velocity of the link's point at the root's origin.
void FrameTerms::add_row(int link, int axis, const Vector3d& from_root, double weight,
                         double residual) {
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  // d x n has two non-zero entries.
  const double at_next = from_root[last], at_last = -from_root[next];
  Composite& sum = composites_[at(link)];
  const double w_next = weight * at_next, w_last = weight * at_last, force = weight * residual;
  sum.linear(axis, axis) += weight;
  sum.mixed(axis, next) += w_next;
  sum.mixed(axis, last) += w_last;
  sum.angular(next, next) += w_next * at_next;
  sum.angular(last, last) += w_last * at_last;
  sum.angular(next, last) += w_next * at_last;
  sum.angular(last, next) += w_next * at_last;
  sum.force[axis] += force;
  sum.torque[next] += force * at_next;
  sum.torque[last] += force * at_last;
}

void FrameTerms::add_targets(const TreeState& pose, const FrameGoals& goals, TermCosts& costs) {
  const Vector3d& origin = pose.origin();
  for (std::size_t k = 0; k < model_.tasks.size(); ++k) {
    const FitTask& task = model_.tasks[k];
    const TaskTarget& target = goals.targets[k];
    const Pose& world = pose.world_from_link[at(task.link)];
    if (task.horizontal_weight > 0.0 || task.height_weight > 0.0) {
      const Vector3d point = world * task.position, weights = position_weights(task, goals);
      const Vector3d error = point - target.position, arm = point - origin;
      for (int axis = 0; axis < 3; ++axis) {
        add_row(task.link, axis, arm, weights[axis], error[axis]);
        costs[kTermPosition] += weights[axis] * square(error[axis]);
      }
    }
    if (task.follows_rotation()) {
      const RotationTerm term = rotation_term(task, goals, world, target);
      composites_[at(task.link)].angular += term.hessian;
      composites_[at(task.link)].torque += term.gradient;
      costs[kTermRotation] += term.cost;
    }
  }
}

void FrameTerms::add_foot_end(const TreeState& pose, const FitFoot& foot, const FitFoot::End& end,
                              const FootEndGoal& goal, const FrameGoals& goals, TermCosts& costs) {
  const Pose& world = pose.world_from_link[at(foot.link)];
  const Vector3d& origin = pose.origin();
  const Matrix3d rotation = world.rotation.toRotationMatrix();
  const auto place = [&](const Vector3d& point) -> Vector3d {
    return world.translation + rotation * point;
  };
  const Vector3d middle = place(end.middle), tip = place(end.tip);
  // A rolling foot stands on its tip, beyond the corners.
  const Vector3d& low = tip.z() < middle.z() ? tip : middle;
  const bool has_clearance = options_.foot_height && goal.importance > 0.0;
  const double lift = has_clearance ? goal.lift : 0.0;
  const bool level = options_.contact && goal.phase >= 0 && goal.level && lift < 1.0;
  const double down = level ? 1.0 - lift : 0.0;
  const int held_by = goal.phase >= 0 ? goal.phase : goal.near_phase;
  if (options_.contact && held_by >= 0) {
    const Eigen::Vector2d error = middle.head<2>() - goals.anchors[at(held_by)] - goal.slide;
    const double weight = square(goals.anchor_hold * goal.hold * options_.contact_weight);
    for (int axis = 0; axis < 2; ++axis) {
      add_row(foot.link, axis, middle - origin, weight, error[axis]);
    }
    costs[kTermContactPlace] += weight * error.squaredNorm();
  }
  if (level) {
    // A foot on its edge touches the surface with its corners.
    const Vector3d sideways = rotation * foot.sideways;
    Vector3d stands = low;
    double error = low.z();
    if (std::abs(sideways.z()) > kLevelLean) {
      stands -= std::copysign(end.half_width, sideways.z()) * sideways;
      error = stands.z() + kLevelLean * end.half_width;
    }
    // A shape that extends beyond the sole touches first when the foot rolls.
    for (const FloorPoint& point : end.shape_points) {
      const Vector3d touching = place(point.position);
      const double height = touching.z() - point.radius + kFootShapeDepth;
      if (height >= error) continue;
      error = height;
      stands = touching;
    }
    error -= goal.support;
    const double weight = square(down * options_.contact_height_weight);
    add_row(foot.link, 2, stands - origin, weight, error);
    costs[kTermContactHeight] += weight * square(error);
  }
  if (down < 1.0 && has_clearance) {
    const double error = low.z() - goal.clearance;
    const double far =
        std::clamp((goal.clearance - goal.support) / options_.foot_height_range, 0.0, 1.0);
    const double near = options_.foot_height_near;
    // A foot that is too low scrapes the floor.
    const double share = (1.0 - down) * (error < 0.0 ? options_.foot_height_below : 1.0);
    const double weight =
        square(share * goal.importance * (near + far * (options_.foot_height_far - near)));
    add_row(foot.link, 2, low - origin, weight, error);
    costs[kTermFootHeight] += weight * square(error);
  }
  if (!options_.floor) return;
  const double weight = square(options_.sole_floor_weight);
  for (const Vector3d& point : end.points) {
    const Vector3d touching = place(point);
    const double depth = touching.z() - (level ? 0.0 : options_.sole_margin);
    const OneSidedRow row = one_sided(depth, kSoleBand);
    if (row.weight <= 0.0) continue;
    add_row(foot.link, 2, touching - origin, weight * row.weight, row.residual);
    costs[kTermFloor] += weight * row.cost;
  }
}

// Pulls the lowest point of a lying foot to the surface below it. It may be the instep or the toes,
// as in kneeling.
void FrameTerms::add_lying_foot(const TreeState& pose, std::size_t f, const FrameGoals& goals,
                                TermCosts& costs) {
  const double lying = lying_share(goals, f);
  if (lying <= 0.0) return;
  const FitFoot& foot = model_.feet[f];
  const Pose& world = pose.world_from_link[at(foot.link)];
  Vector3d touching = world.translation;
  double height = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const Vector3d& point, double below) {
    const Vector3d place = world * point;
    if (place.z() - below >= height) return;
    height = place.z() - below;
    touching = place;
  };
  for (const std::size_t e : {kHeelEnd, kToeEnd}) {
    const FitFoot::End& end = foot.ends[e];
    const double support = goals.ends[2 * f + e].support;
    for (const Vector3d& point : end.points) look_at(point, support);
    for (const FloorPoint& point : end.shape_points) {
      look_at(point.position, point.radius + support);
    }
  }
  const double weight = square(lying * options_.body_contact_height_weight);
  add_row(foot.link, 2, touching - pose.origin(), weight, height);
  costs[kTermContactHeight] += weight * square(height);
}

void FrameTerms::add_feet(const TreeState& pose, const FrameGoals& goals, TermCosts& costs) {
  for (std::size_t f = 0; f < model_.feet.size(); ++f) {
    const FitFoot& foot = model_.feet[f];
    for (const std::size_t end : {kHeelEnd, kToeEnd}) {
      add_foot_end(pose, foot, foot.ends[end], goals.ends[2 * f + end], goals, costs);
    }
    if (options_.contact) add_lying_foot(pose, f, goals, costs);
  }
}

// Pulls the lowest point of a support body to the floor. Points of equal height share the weight:
// in a body that lies symmetrically, rounding would otherwise choose one of them in every step.
void FrameTerms::add_support_height(const TreeState& pose, const SupportBody& body, double weight,
                                    TermCosts& costs) {
  constexpr double kEqual = 1e-5;  // Metres.
  touches_.clear();
  double lowest = HUGE_VAL;
  for (const SupportBody::Point& point : body.points) {
    touches_.push_back(SupportBody::touch_of(point, pose));
    lowest = std::min(lowest, touches_.back().height);
  }
  const auto share_of = [&](const SupportBody::Touch& touch) {
    return square(std::max(0.0, 1.0 - (touch.height - lowest) / kEqual));
  };
  double sum = 0.0;
  for (const SupportBody::Touch& touch : touches_) sum += share_of(touch);
  for (const SupportBody::Touch& touch : touches_) {
    const double shared = weight * share_of(touch) / sum;
    if (shared <= 0.0) continue;
    const double height = touch.height - options_.body_margin;
    add_row(touch.link, 2, touch.place - pose.origin(), shared, height);
    costs[kTermContactHeight] += shared * square(height);
  }
}

// Holds each support body at its anchor and on the floor.
void FrameTerms::add_supports(const TreeState& pose, const FrameGoals& goals, TermCosts& costs) {
  const Vector3d& origin = pose.origin();
  for (std::size_t i = 0; i < goals.supports.size(); ++i) {
    const SupportGoal& goal = goals.supports[i];
    if (goal.phase < 0) continue;
    const SupportBody& body = model_.supports[i];
    const Vector3d middle = body.world_middle(pose);
    const Eigen::Vector2d error = middle.head<2>() - goals.anchors[at(goal.phase)] - goal.slide;
    const double place = square(goals.anchor_hold * goal.share * options_.body_contact_weight);
    for (int axis = 0; axis < 2; ++axis) {
      add_row(body.link, axis, middle - origin, place, error[axis]);
    }
    costs[kTermContactPlace] += place * error.squaredNorm();
    add_support_height(pose, body, square(goal.share * options_.body_contact_height_weight), costs);
  }
}

void FrameTerms::add_floor(const TreeState& pose, const FrameGoals& goals, TermCosts& costs) {
  const Vector3d& origin = pose.origin();
  for (std::size_t link = 0; link < composites_.size(); ++link) {
    // The bottom of a foot's shapes is its sole, which has its own rows.
    const bool is_foot = model_.is_foot[link] != 0;
    const double margin = is_foot ? -options_.sole_margin : options_.body_margin;
    const bool stands = is_foot && lying_share(goals, at(model_.foot_of_link[link])) <= 0.0;
    const double weight = square(stands ? options_.sole_floor_weight : options_.body_floor_weight);
    const Pose& world = pose.world_from_link[link];
    if (model_.floor_points[link].empty() ||
        world.translation.z() > model_.floor_reach[link] + margin + kBodyBand) {
      continue;
    }
    const Matrix3d rotation = world.rotation.toRotationMatrix();
    for (const FloorPoint& point : model_.floor_points[link]) {
      const double depth =
          world.translation.z() + rotation.row(2).dot(point.position) - point.radius - margin;
      const OneSidedRow row = one_sided(depth, kBodyBand);
      if (row.weight <= 0.0) continue;
      add_row(static_cast<int>(link), 2, world * point.position - origin, weight * row.weight,
              row.residual);
      costs[kTermFloor] += weight * row.cost;
    }
  }
}

// The row's non-zero entries belong to the two chains between the links and their last common
// ancestor. Without a Hessian, adds only the cost.
void FrameTerms::add_pair(const TreeState& pose, const FitPair& pair, double share,
                          double* gradient, double* hessian, int stride, TermCosts& costs) {
  const FitShape &a = model_.shapes[at(pair.a)], &b = model_.shapes[at(pair.b)];
  const ShapeDistance found = distance_of(pose, a, b);
  const double apart = found.distance - options_.self_collision_margin;
  const OneSidedRow row = one_sided(apart, kOverlapBand);
  if (row.weight <= 0.0) return;
  const double squared_weight = share * square(options_.self_collision_weight);
  const double weight = squared_weight * row.weight;
  costs[kTermSelfCollision] += squared_weight * row.cost;
  if (hessian == nullptr) return;
  const int foot_a = model_.foot_of_link[at(a.link)], foot_b = model_.foot_of_link[at(b.link)];
  if (foot_a >= 0 && foot_b >= 0 && foot_a != foot_b && -apart > foot_overlap_.depth) {
    foot_overlap_ = {-apart, foot_a, foot_b, -found.normal.head<2>()};
  }
  const Vector3d& origin = pose.origin();
  // The torque is the same about both nearest points, because they lie on one line along the
  // normal.
  const Vector3d torque = (found.on_a - origin).cross(found.normal);
  const auto chain_a = model_.tree.carriers(KinematicTree::dof_of(a.link));
  const auto chain_b = model_.tree.carriers(KinematicTree::dof_of(b.link));
  const auto parting = std::ranges::mismatch(chain_a, chain_b);
  row_dofs_.assign(parting.in1, chain_a.end());
  for (const int i : row_dofs_) {
    row_[at(i)] = -(found.normal.dot(pose.linear[at(i)]) + torque.dot(pose.angular[at(i)]));
  }
  for (const int i : std::span(parting.in2, chain_b.end())) {
    row_[at(i)] = found.normal.dot(pose.linear[at(i)]) + torque.dot(pose.angular[at(i)]);
    row_dofs_.push_back(i);
  }
  for (const int i : row_dofs_) {
    const double scaled = weight * row_[at(i)];
    gradient[i] += scaled * row.residual;
    double* const out = hessian + static_cast<std::ptrdiff_t>(i) * stride;
    for (const int j : row_dofs_) {
      if (j <= i) out[j] += scaled * row_[at(j)];
    }
  }
}

void FrameTerms::add_terms(const TreeState& pose, const FrameGoals& goals, TermCosts& costs) {
  std::ranges::fill(composites_, Composite{});
  foot_overlap_ = {};
  add_targets(pose, goals, costs);
  add_feet(pose, goals, costs);
  if (options_.contact) add_supports(pose, goals, costs);
  if (options_.floor) add_floor(pose, goals, costs);
  if (goals.scene != nullptr) {
    for (std::size_t f = 0; f < stands_.size(); ++f) {
      stands_[f] = in_contact(goals, f) && lying_share(goals, f) <= 0.0 ? 1 : 0;
    }
    const SceneCosts added =
        add_scene_terms(model_, options_, *goals.scene, goals.frame, pose, stands_, composites_);
    costs[kTermSceneContact] += added.contact;
    costs[kTermScene] += added.penetration;
  }
}

void FrameTerms::add_costs(const TreeState& pose, const FrameGoals& goals,
                           std::span<const std::uint32_t> pairs, TermCosts& costs) {
  add_terms(pose, goals, costs);
  if (!options_.self_collision) return;
  for (const std::uint32_t pair : pairs) {
    add_pair(pose, model_.pairs[pair], 1.0, nullptr, nullptr, 0, costs);
  }
}

void FrameTerms::assemble(const TreeState& pose, const FrameGoals& goals,
                          std::span<const std::uint32_t> pairs, double* gradient, double* hessian,
                          int stride, TermCosts& costs) {
  add_terms(pose, goals, costs);
  retarget::assemble(pose, composites_, tree_hessian_, {gradient, row_.size()});
  write_lower_triangle(model_.tree, tree_hessian_, hessian, stride);
  if (!options_.self_collision) return;
  for (const std::uint32_t pair : pairs) {
    add_pair(pose, model_.pairs[pair], 1.0, gradient, hessian, stride, costs);
  }
}

void FrameTerms::add_crossings(const TreeState& half_way, std::span<const std::uint32_t> pairs,
                               double* gradient, double* hessian, int stride, TermCosts& costs) {
  const FootOverlap of_frame = foot_overlap_;
  for (const std::uint32_t pair : pairs) {
    add_pair(half_way, model_.pairs[pair], 0.5, gradient, hessian, stride, costs);
  }
  foot_overlap_ = of_frame;
}

void add_limit_margins(const FitModel& model, const FitOptions& options,
                       std::span<const double> qpos, double* gradient, double* hessian, int stride,
                       TermCosts& costs) {
  constexpr double kShare = 0.03;  // Of the range, at either end.
  // Curvature of the solver relative to that of the cost, which grows along a step to the limit.
  constexpr double kStiffer = 1.5;
  if (options.limit_margin_weight == 0.0) return;
  for (int i = KinematicTree::kBaseDofs; i < model.dof_count(); ++i) {
    const double margin = kShare * (model.upper[at(i)] - model.lower[at(i)]);
    if (!(margin > 0.0) || !std::isfinite(margin)) continue;
    const auto& link = model.tree.links()[at(i - KinematicTree::kBaseDofs + 1)];
    const double value = qpos[at(link.qpos_address)];
    const double below = value - model.lower[at(i)], above = model.upper[at(i)] - value;
    const double depth = 1.0 - std::min(below, above) / margin;
    if (depth <= 0.0) continue;
    const double at_limit = 0.5 * square(options.limit_margin_weight);
    costs[kTermLimits] += at_limit * square(depth) * depth;
    if (hessian == nullptr) continue;
    gradient[i] += (below < above ? -1.5 : 1.5) * at_limit * square(depth) / margin;
    hessian[static_cast<std::ptrdiff_t>(i) * (stride + 1)] +=
        kStiffer * 3.0 * at_limit * depth / square(margin);
  }
}

}  // namespace retarget
