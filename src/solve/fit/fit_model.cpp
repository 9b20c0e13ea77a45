#include "solve/fit/fit_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "retarget/pose.h"
#include "retarget/shape_distance.h"
#include "robot/model/sole_ends.h"
#include "solve/fit/arm_tasks.h"
#include "solve/fit/shorthand.h"

namespace retarget {

using Eigen::Vector3d;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class ModelMaker {
 public:
  ModelMaker(const Robot& robot, const ResolvedConfig& config, const LimitSet& limits,
             const BoneArray<int>& target_of_bone, const FitOptions& options,
             const SourceSides& sides)
      : robot_(robot),
        config_(config),
        limits_(limits),
        target_of_bone_(target_of_bone),
        options_(options),
        sides_(sides) {}

  FitModel make();

 private:
  void add_dofs();
  void add_smoothness();
  void add_tasks();
  void add_feet();
  void hold_unmapped_joints();
  void add_shapes();
  void add_foot_shapes();
  void add_pairs();
  void group_pairs();
  [[nodiscard]] int link_of_bone(Bone bone) const;
  [[nodiscard]] int body_above(int link) const;
  /// The link itself if its joint can move, else its nearest ancestor whose joint can.
  [[nodiscard]] int carrier(int link) const;
  [[nodiscard]] int parent(int link) const { return model_.tree.links()[link].parent; }
  [[nodiscard]] const KinematicTree::Attachment& attachment(int body) const {
    return model_.tree.attachment(body);
  }

  const Robot& robot_;
  const ResolvedConfig& config_;
  const LimitSet& limits_;
  const BoneArray<int>& target_of_bone_;
  const FitOptions& options_;
  const SourceSides& sides_;
  FitModel model_;
  std::vector<int> shape_body_;  // One per shape.
};

FitModel ModelMaker::make() {
  model_.configuration_size = robot_.configuration_size();
  model_.inertias = make_inertias(robot_);
  add_dofs();
  add_smoothness();
  add_tasks();
  add_feet();
  hold_unmapped_joints();
  relate_arm_tasks(options_.weights, model_);
  add_shapes();
  add_foot_shapes();
  if (options_.contact) model_.supports = support_bodies(robot_, config_);
  add_pairs();
  group_pairs();
  return std::move(model_);
}

void ModelMaker::add_dofs() {
  model_.tree = robot_.tree();
  model_.base_is_held = robot_.fixed_base();
  const double root = model_.base_is_held ? 0.0 : kInfinity;
  model_.lower.assign(KinematicTree::kBaseDofs, -root);
  model_.upper.assign(KinematicTree::kBaseDofs, root);
  model_.speed_limit.assign(KinematicTree::kBaseDofs, kInfinity);
  for (std::size_t link = 1; link < model_.tree.links().size(); ++link) {
    const int joint = model_.tree.links()[link].joint;
    model_.lower.push_back(limits_.lower[joint]);
    model_.upper.push_back(limits_.upper[joint]);
    model_.speed_limit.push_back(robot_.speed_limit(joint));
  }
  model_.torque_limit = torque_limits_of(robot_);
}

int ModelMaker::link_of_bone(Bone bone) const {
  const int body = config_.body_of(bone);
  return body < 0 ? KinematicTree::kWorld : attachment(body).link;
}

// An arm is the chain that carries one hand, or one forearm of a robot without hands, but not the
// other; a wrist is its part beyond the forearm.
void ModelMaker::add_smoothness() {
  const auto& o = options_;
  model_.smoothness.assign(model_.dof_count(), o.smoothness_leg);
  std::fill_n(model_.smoothness.begin(), 3, o.smoothness_root_position);
  std::fill_n(model_.smoothness.begin() + 3, 3, o.smoothness_root_rotation);
  const auto end_of_arm = [&](Bone hand, Bone forearm) {
    const int link = link_of_bone(hand);
    return link > 0 ? link : link_of_bone(forearm);
  };
  const int left = end_of_arm(Bone::kLeftHand, Bone::kLeftForeArm);
  const int right = end_of_arm(Bone::kRightHand, Bone::kRightForeArm);
  const auto mark = [&](int hand, int other, int forearm) {
    bool wrist = forearm > 0 && model_.tree.carries(forearm, hand);
    for (int link = hand; link > 0 && !model_.tree.carries(link, other); link = parent(link)) {
      if (link == forearm) wrist = false;
      model_.smoothness[KinematicTree::dof_of(link)] =
          wrist ? o.smoothness_wrist : o.smoothness_arm;
    }
  };
  mark(left, right, link_of_bone(Bone::kLeftForeArm));
  mark(right, left, link_of_bone(Bone::kRightForeArm));
}

// Factor for the tracking weight of a task that the retargeting configuration weights less than
// usual.
double importance(double weight, double usual) {
  return weight > 0.0 ? std::sqrt(std::min(1.0, weight / usual)) : 0.0;
}

// Tracking weights of one kind of bone.
struct Tracking {
  double position, rotation, twist;
  double usual_position, usual_rotation;  // Configuration weights at which these apply in full.
};

Tracking tracking_of(Bone bone, const TrackingWeights& w) {
  const auto of = [](double position, double rotation, double usual_position,
                     double usual_rotation) {
    return Tracking{position, rotation, rotation, usual_position, usual_rotation};
  };
  if (bone == Bone::kHips) return of(w.hips_position, w.hips_rotation, 100.0, 5.0);
  if (bone == Bone::kSpine2) return of(w.hips_position, w.torso_rotation, 10.0, 10.0);
  const std::optional<LimbBone> part = limb_bone(bone);
  if (part == LimbBone::kUpLeg) {
    return {w.thigh_position, w.thigh_rotation, w.thigh_twist, 10.0, 5.0};
  }
  if (part == LimbBone::kLeg) {
    return {w.shank_position, w.shank_rotation, w.shank_twist, 10.0, 5.0};
  }
  if (part == LimbBone::kFoot || part == LimbBone::kFootMod) {
    return of(w.foot_position, w.foot_rotation, 50.0, 10.0);
  }
  if (part == LimbBone::kForeArm) {
    return of(w.forearm_position, w.forearm_rotation, 10.0, 5.0);
  }
  if (part == LimbBone::kArm) {
    return of(w.upper_arm_position, w.upper_arm_rotation, 5.0, 100.0);
  }
  if (part == LimbBone::kHand) return of(w.hand_position, w.hand_rotation, 10.0, 5.0);
  return of(w.other_position, w.other_rotation, 10.0, 5.0);
}

void ModelMaker::add_tasks() {
  if (!options_.tracking) return;
  for (const ConfigTask& row : config_.match_tables[config_.match_tables[1].used ? 1 : 0].tasks) {
    if (!row.has_weight() || target_of_bone_[row.bone] < 0) continue;
    const KinematicTree::Attachment& attached = attachment(row.body);
    if (attached.link < 0) continue;
    const Tracking kind = tracking_of(row.bone, options_.weights);
    FitTask task;
    task.body = robot_.bodies()[row.body].name;
    task.link = attached.link;
    task.target = target_of_bone_[row.bone];
    task.bone = row.bone;
    task.position = attached.link_from_body.translation;
    task.link_from_body = attached.link_from_body.rotation.normalized();
    task.horizontal_weight = task.height_weight =
        kind.position * importance(row.position_weight, kind.usual_position);
    const double turns = importance(row.rotation_weight, kind.usual_rotation) *
                         (row.rotation_is_guess ? kGuessedRotationShare : 1.0);
    task.rotation_weight = kind.rotation * turns;
    task.twist_weight = kind.twist * turns;
    // The x axis of a bone points along it.
    task.twist_axis = task.link_from_body * (row.rotation_offset.conjugate() * Vector3d::UnitX());
    model_.tasks.push_back(task);
  }
}

// Converts one end of a sole to the link frame.
FitFoot::End make_end(const SolePoints& sole, const Pose& link_from_body) {
  FitFoot::End end;
  end.middle = link_from_body * sole.middle;
  end.tip = link_from_body * sole.tip;
  end.half_width = sole.half_width;
  for (const auto& point : sole.points) end.points.push_back(link_from_body * point);
  return end;
}

void ModelMaker::add_feet() {
  model_.is_foot.assign(model_.tree.links().size(), 0);
  model_.foot_of_link.assign(model_.tree.links().size(), -1);
  for (const Sole& sole : robot_.profile().soles) {
    const KinematicTree::Attachment& attached = attachment(sole.body);
    const bool followed = sole.side == "left" ? sides_.left : sides_.right;
    if (!followed || attached.link < 0) continue;
    const auto shape = sole_shape(sole);
    if (!shape) continue;
    const Pose& link_from_body = attached.link_from_body;
    FitFoot foot;
    foot.link = attached.link;
    foot.left = sole.side == "left";
    foot.body = sole.body;
    foot.ends[kHeelEnd] = make_end(shape->ends[kSoleHeel], link_from_body);
    foot.ends[kToeEnd] = make_end(shape->ends[kSoleToe], link_from_body);
    foot.sideways = link_from_body.rotation * shape->sideways;
    foot.body_height = shape->body_height;
    for (FitTask& task : model_.tasks) {
      if (task.link == foot.link) task.foot = static_cast<int>(model_.feet.size());
    }
    model_.is_foot[foot.link] = 1;
    for (const int link : {foot.link, parent(foot.link)}) {
      if (link >= 0) model_.foot_of_link[link] = static_cast<int>(model_.feet.size());
    }
    model_.feet.push_back(foot);
  }
}

// Largest radius by which a box is rounded, metres; rounding cuts off its edges. Thin boxes are
// rounded by half their smallest side.
constexpr double kMaxRounding = 0.008;

// Holds fingers and other joints that carry neither a task's body nor a sole at the robot's zero
// configuration. Otherwise only smoothness and collisions would move them.
void ModelMaker::hold_unmapped_joints() {
  std::vector<bool> moves(model_.tree.links().size(), false);
  const auto mark = [&](int link) {
    for (; link > 0; link = parent(link)) moves[link] = true;
  };
  for (const auto& [used, tasks] : config_.match_tables) {
    for (const ConfigTask& task : tasks) {
      if (used && task.has_weight()) mark(attachment(task.body).link);
    }
  }
  for (const FitFoot& foot : model_.feet) mark(foot.link);
  const std::vector<double> zero = robot_.zero_configuration();
  for (std::size_t link = 1; link < model_.tree.links().size(); ++link) {
    if (moves[link]) continue;
    const int dof = KinematicTree::dof_of(static_cast<int>(link));
    double &lower = model_.lower[dof], &upper = model_.upper[dof];
    const double position = zero[model_.tree.links()[link].qpos_address];
    lower = upper = std::max(lower, std::min(position, upper));
  }
}

void ModelMaker::add_shapes() {
  model_.floor_points.resize(model_.tree.links().size());
  model_.floor_reach.assign(model_.tree.links().size(), 0.0);
  for (const CollisionShape& shape : robot_.collision_shapes()) {
    const KinematicTree::Attachment& attached = attachment(shape.body);
    if (attached.link < 0) continue;
    model_.shapes.push_back(
        {placed(rounded(shape, kMaxRounding), attached.link_from_body), attached.link});
    shape_body_.push_back(shape.body);
    for (const Eigen::Vector3d& point : core_points(shape)) {
      const Eigen::Vector3d place = attached.link_from_body * point;
      model_.floor_points[attached.link].push_back({place, shape.radius});
      double& reach = model_.floor_reach[attached.link];
      reach = std::max(reach, place.norm() + shape.radius);
    }
  }
}

// Assigns the points of a foot's shapes to its heel or its toe.
void ModelMaker::add_foot_shapes() {
  for (FitFoot& foot : model_.feet) {
    const Eigen::Vector3d forward = foot.ends[kToeEnd].middle - foot.ends[kHeelEnd].middle;
    const Eigen::Vector3d middle = 0.5 * (foot.ends[kToeEnd].middle + foot.ends[kHeelEnd].middle);
    for (const FloorPoint& point : model_.floor_points[foot.link]) {
      const std::size_t end = forward.dot(point.position - middle) > 0.0 ? kToeEnd : kHeelEnd;
      foot.ends[end].shape_points.push_back(point);
    }
  }
}

// The link of the parent of the link's body. It may differ from the parent link, because a body may
// have several joints.
int ModelMaker::body_above(int link) const {
  return attachment(robot_.bodies()[model_.tree.links()[link].body].parent).link;
}

int ModelMaker::carrier(int link) const {
  const auto held = [&](int of) {
    const int dof = KinematicTree::dof_of(of);
    return model_.lower[dof] == model_.upper[dof];
  };
  while (link > 0 && held(link)) link = parent(link);
  return link;
}

// Collects all pairs of shapes except those within one link, those of a body and its parent, and
// those whose contact the profile allows.
void ModelMaker::add_pairs() {
  std::set<std::pair<int, int>> allowed;
  for (const auto& [a, b] : robot_.profile().allowed_self_contact) {
    allowed.insert({a, b});
    allowed.insert({b, a});
  }
  const int count = static_cast<int>(model_.shapes.size());
  for (int a = 0; a < count; ++a) {
    const int link_a = model_.shapes[a].link;
    for (int b = a + 1; b < count; ++b) {
      const int link_b = model_.shapes[b].link;
      // The relative pose of these links is fixed, so the fit cannot separate their shapes.
      if (carrier(link_a) == carrier(link_b)) continue;
      if (body_above(link_a) == link_b || body_above(link_b) == link_a) continue;
      if (allowed.contains({shape_body_[a], shape_body_[b]})) {
        continue;
      }
      model_.pairs.push_back({a, b});
    }
  }
}

// Groups the pairs by link pair and bounds each link's shapes by a sphere. Most links are far
// apart, so that a test of two spheres skips a whole group.
void ModelMaker::group_pairs() {
  const auto links = [&](const FitPair& pair) {
    return std::pair(model_.shapes[pair.a].link, model_.shapes[pair.b].link);
  };
  std::ranges::stable_sort(model_.pairs, {}, links);
  for (std::uint32_t i = 0; i < model_.pairs.size(); ++i) {
    const auto [link_a, link_b] = links(model_.pairs[i]);
    if (i == 0 || links(model_.pairs[i - 1]) != std::pair(link_a, link_b)) {
      model_.pair_groups.push_back({link_a, link_b, i, i});
    }
    model_.pair_groups.back().end = i + 1;
  }
  model_.link_spheres.resize(model_.tree.links().size());
  for (std::size_t link = 0; link < model_.tree.links().size(); ++link) {
    Eigen::AlignedBox3d box;
    for (const FloorPoint& point : model_.floor_points[link]) box.extend(point.position);
    if (box.isEmpty()) continue;
    BoundingSphere& sphere = model_.link_spheres[link];
    sphere.centre = box.center();
    for (const FloorPoint& point : model_.floor_points[link]) {
      sphere.radius =
          std::max(sphere.radius, (point.position - sphere.centre).norm() + point.radius);
    }
  }
}

// Share of the twist's weight. A twist of the upper arm by a small angle moves the forearm by the
// sine of the elbow's bend; the squared weight follows the square of this movement.
double twist_share(double straight_twist, const Vector3d& upper, const Vector3d& lower) {
  const double moved = upper.dot(lower) < 0.0 ? 1.0 : upper.cross(lower).squaredNorm();
  return std::sqrt(moved + square(straight_twist) * (1.0 - moved));
}

}  // namespace

void append_targets(const FitModel& model, std::span<const Pose> world_from_target,
                    const Vector3d& offset, std::vector<TaskTarget>& targets) {
  const std::size_t first = targets.size();
  for (const FitTask& task : model.tasks) {
    const Pose& pose = world_from_target[at(task.target)];
    targets.push_back(
        {pose.translation + offset, pose.rotation.normalized() * task.link_from_body.conjugate()});
  }
  const auto bone = [&](std::size_t k) -> Vector3d {
    return targets[first + k].world_from_link * model.tasks[k].twist_axis;
  };
  for (std::size_t k = 0; k < model.tasks.size(); ++k) {
    const FitTask& task = model.tasks[k];
    if (task.forearm < 0) continue;
    targets[first + k].twist_share =
        twist_share(task.straight_twist, bone(k), bone(at(task.forearm)));
  }
}

FitModel make_fit_model(const Robot& robot, const ResolvedConfig& config, const LimitSet& limits,
                        const BoneArray<int>& target_of_bone, const FitOptions& options,
                        const SourceSides& sides) {
  return ModelMaker(robot, config, limits, target_of_bone, options, sides).make();
}

}  // namespace retarget
