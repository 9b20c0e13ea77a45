#include "refine/fit_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string_view>

#include "ik/moving_tree.h"

namespace retarget {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Frame to_frame(const Pose& pose) {
  return {pose.rotation.normalized().toRotationMatrix(), pose.translation};
}

// where each body hangs: its link, or -1 where it does not move at all
struct Hanging {
  int link = -1;
  Pose link_from_body;
};

class ModelMaker {
 public:
  ModelMaker(const Robot& robot, const ResolvedMapping& tables, const LimitSet& limits,
             const BoneArray<int>& target_of_bone, const FitOptions& options,
             const SourceSides& sides)
      : robot_(robot),
        tables_(tables),
        limits_(limits),
        target_of_bone_(target_of_bone),
        options_(options),
        sides_(sides) {}

  FitModel make();

 private:
  void add_links();
  void add_smoothness();
  void add_tasks();
  void add_feet();
  void hold_unmapped_joints();
  void add_shapes();
  void add_floor_points(const CollisionShape& shape, const Frame& link_from_shape);
  void add_foot_shapes();
  void add_pairs();
  void group_pairs();
  [[nodiscard]] int link_of_bone(Bone bone) const;
  [[nodiscard]] int body_above(int link) const;
  /// The link itself or the next one above that moves.
  [[nodiscard]] int carrier(int link) const;
  [[nodiscard]] std::vector<int> chain_to_root(int link) const;

  const Robot& robot_;
  const ResolvedMapping& tables_;
  const LimitSet& limits_;
  const BoneArray<int>& target_of_bone_;
  const FitOptions& options_;
  const SourceSides& sides_;
  FitModel model_;
  std::vector<Hanging> hanging_;  // by body
  std::vector<int> shape_body_;   // by shape
};

FitModel ModelMaker::make() {
  model_.configuration_size = robot_.configuration_size();
  add_links();
  add_smoothness();
  add_tasks();
  add_feet();
  hold_unmapped_joints();
  add_shapes();
  add_foot_shapes();
  add_pairs();
  group_pairs();
  return std::move(model_);
}

void ModelMaker::add_links() {
  std::vector<int> bodies(robot_.bodies().size());
  std::iota(bodies.begin(), bodies.end(), 0);
  const MovingTree tree(robot_, bodies);
  model_.links.emplace_back();
  model_.links.front().body = robot_.root_body();
  model_.dof_parent = {-1, 0, 1, 2, 3, 4};
  constexpr int kLastOfBase = FitModel::kBaseDofs - 1;
  model_.lower.assign(FitModel::kBaseDofs, -kInfinity);
  model_.upper.assign(FitModel::kBaseDofs, kInfinity);
  model_.speed_limit.assign(FitModel::kBaseDofs, kInfinity);
  for (const MovingTree::Node& node : tree.nodes()) {
    const RobotJoint& joint = robot_.joints()[static_cast<std::size_t>(node.joint)];
    FitLink link;
    link.parent = node.parent + 1;
    link.body = joint.body;
    link.slides = node.slides;
    link.qpos_address = node.qpos_address;
    link.reference = node.reference;
    link.parent_from_link = to_frame(node.parent_from_node);
    link.joint = joint.name;
    model_.links.push_back(link);
    model_.dof_parent.push_back(kLastOfBase + link.parent);
    model_.lower.push_back(limits_.lower[static_cast<std::size_t>(node.joint)]);
    model_.upper.push_back(limits_.upper[static_cast<std::size_t>(node.joint)]);
    model_.speed_limit.push_back(robot_.speed_limit(node.joint));
  }
  for (const MovingTree::Attachment& attachment : tree.attachments()) {
    if (attachment.node == MovingTree::kWorld) {
      hanging_.emplace_back();
    } else {
      hanging_.push_back({attachment.node + 1, attachment.node_from_body});
    }
  }
}

int ModelMaker::link_of_bone(Bone bone) const {
  for (const auto& [used, tasks] : tables_.tables) {
    for (const MappedTask& task : tasks) {
      if (task.bone != bone || task.body < 0) continue;
      return hanging_[static_cast<std::size_t>(task.body)].link;
    }
  }
  return -1;
}

std::vector<int> ModelMaker::chain_to_root(int link) const {
  std::vector<int> chain;
  for (; link > 0; link = model_.links[static_cast<std::size_t>(link)].parent) {
    chain.push_back(link);
  }
  return chain;
}

// arms are what carries one hand and not the other; wrists what comes behind the forearm
void ModelMaker::add_smoothness() {
  const auto& o = options_;
  const int dofs = model_.dof_count();
  model_.smoothness.assign(static_cast<std::size_t>(dofs), o.smoothness_leg);
  std::fill_n(model_.smoothness.begin(), 3, o.smoothness_root_position);
  std::fill_n(model_.smoothness.begin() + 3, 3, o.smoothness_root_rotation);
  const std::vector<int> left = chain_to_root(link_of_bone(Bone::kLeftHand));
  const std::vector<int> right = chain_to_root(link_of_bone(Bone::kRightHand));
  const auto mark = [&](const std::vector<int>& arm, const std::vector<int>& other, int forearm) {
    bool wrist = std::ranges::find(arm, forearm) != arm.end();
    for (const int link : arm) {
      if (std::ranges::find(other, link) != other.end()) break;
      if (link == forearm) wrist = false;
      model_.smoothness[static_cast<std::size_t>(link + FitModel::kBaseDofs - 1)] =
          wrist ? o.smoothness_wrist : o.smoothness_arm;
    }
  };
  mark(left, right, link_of_bone(Bone::kLeftForeArm));
  mark(right, left, link_of_bone(Bone::kRightForeArm));
}

// what a mapping holds less important than usual is less important here too
double importance(double weight, double usual) {
  return weight > 0.0 ? std::sqrt(std::min(1.0, weight / usual)) : 0.0;
}

// how well a kind of bone is tracked
struct Tracking {
  double position, rotation;
  double usual_position, usual_rotation;  // weights of the mapping that these are for
};

Tracking tracking_of(Bone bone, const TrackingWeights& w) {
  if (bone == Bone::kHips) return {w.hips_position, w.hips_rotation, 100.0, 5.0};
  if (bone == Bone::kSpine2) return {w.hips_position, w.torso_rotation, 10.0, 10.0};
  const std::optional<LimbBone> part = limb_bone(bone);
  if (part == LimbBone::kUpLeg) return {w.thigh_position, w.thigh_rotation, 10.0, 5.0};
  if (part == LimbBone::kLeg) return {w.shank_position, w.shank_rotation, 10.0, 5.0};
  if (part == LimbBone::kFoot || part == LimbBone::kFootMod) {
    return {w.foot_position, w.foot_rotation, 50.0, 10.0};
  }
  if (part == LimbBone::kForeArm) return {w.forearm_position, w.forearm_rotation, 10.0, 5.0};
  if (part == LimbBone::kArm) return {w.upper_arm_position, w.upper_arm_rotation, 5.0, 100.0};
  if (part == LimbBone::kHand) return {w.hand_position, w.hand_rotation, 10.0, 5.0};
  return {w.other_position, w.other_rotation, 10.0, 5.0};
}

void ModelMaker::add_tasks() {
  if (!options_.tracking) return;
  for (const MappedTask& mapped : tables_.tables[tables_.tables[1].used ? 1 : 0].tasks) {
    if (!mapped.has_weight() || target_of_bone_[mapped.bone] < 0) continue;
    const Hanging& hanging = hanging_[static_cast<std::size_t>(mapped.body)];
    if (hanging.link < 0) continue;
    const Tracking kind = tracking_of(mapped.bone, options_.weights);
    FitTask task;
    task.body = robot_.bodies()[static_cast<std::size_t>(mapped.body)].name;
    task.link = hanging.link;
    task.target = target_of_bone_[mapped.bone];
    task.position = hanging.link_from_body.translation;
    task.link_from_body = hanging.link_from_body.rotation.normalized();
    task.horizontal_weight = task.height_weight =
        kind.position * importance(mapped.position_weight, kind.usual_position);
    task.rotation_weight = kind.rotation * importance(mapped.rotation_weight, kind.usual_rotation);
    model_.tasks.push_back(task);
  }
}

// the points of one end of a sole, in the body's frame
FitFoot::End make_end(const std::vector<Eigen::Vector3d>& corners,
                      const std::vector<Eigen::Vector3d>& all, const Eigen::Vector3d& outwards,
                      const Frame& link_from_body) {
  FitFoot::End end;
  for (const auto& corner : corners) end.middle += corner / static_cast<double>(corners.size());
  double reach = 0.0;
  for (const auto& point : all) reach = std::max(reach, outwards.dot(point - end.middle));
  end.tip = link_from_body * (end.middle + reach * outwards);
  end.middle = link_from_body * end.middle;
  for (const auto& point : all) end.points.push_back(link_from_body * point);
  return end;
}

// which end of a sole each of its points belongs to: by its label, else by where it lies
std::vector<int> ends_of_points(const Sole& sole) {
  std::vector<int> ends;
  if (sole.labels.size() == sole.points.size()) {
    for (const std::string& label : sole.labels) {
      const bool heel = label.starts_with("heel"), toe = label.starts_with("toe");
      ends.push_back(heel ? kHeel : toe ? kToe : -1);
    }
    if (std::ranges::count(ends, kHeel) > 0 && std::ranges::count(ends, kToe) > 0) return ends;
  }
  // the sole's longest line runs from heel to toe, and the ankle stands nearer to the heel
  ends.assign(sole.points.size(), kHeel);
  double longest = 0.0;
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;
  for (const auto& a : sole.points) {
    for (const auto& b : sole.points) {
      if ((b - a).norm() <= longest) continue;
      longest = (b - a).norm();
      from = a.norm() <= b.norm() ? a : b;
      to = a.norm() <= b.norm() ? b : a;
    }
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    if ((sole.points[i] - 0.5 * (from + to)).dot(to - from) > 0.0) ends[i] = kToe;
  }
  return ends;
}

void ModelMaker::add_feet() {
  model_.is_foot.assign(model_.links.size(), 0);
  model_.foot_of_link.assign(model_.links.size(), -1);
  for (const Sole& sole : robot_.profile().soles) {
    const Hanging& hanging = hanging_[static_cast<std::size_t>(sole.body)];
    const bool followed = sole.side == "left" ? sides_.left : sides_.right;
    if (!followed || hanging.link < 0 || sole.points.size() < 2) continue;
    const std::vector<int> ends = ends_of_points(sole);
    std::array<std::vector<Eigen::Vector3d>, 2> all, corners;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends[i] < 0) continue;
      const auto end = static_cast<std::size_t>(ends[i]);
      all[end].push_back(sole.points[i]);
      const bool tip = i < sole.labels.size() && sole.labels[i].ends_with("_tip");
      if (!tip) corners[end].push_back(sole.points[i]);
    }
    FitFoot foot;
    if (all[kHeel].empty() || all[kToe].empty()) continue;
    for (const std::size_t end : {kHeel, kToe}) {
      if (corners[end].empty()) corners[end] = all[end];
    }
    const auto mean = [](const std::vector<Eigen::Vector3d>& points) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const auto& point : points) sum += point;
      return Eigen::Vector3d(sum / static_cast<double>(points.size()));
    };
    const Eigen::Vector3d forward = (mean(corners[kToe]) - mean(corners[kHeel])).normalized();
    const Frame link_from_body = to_frame(hanging.link_from_body);
    foot.link = hanging.link;
    foot.left = sole.side == "left";
    foot.body = sole.body;
    foot.ends[kHeel] = make_end(corners[kHeel], all[kHeel], -forward, link_from_body);
    foot.ends[kToe] = make_end(corners[kToe], all[kToe], forward, link_from_body);
    // distance of the origin from the heel-toe line is its height, for ankles stand above it
    const Eigen::Vector3d heel = mean(corners[kHeel]);
    const Eigen::Vector3d above = forward * forward.dot(heel) - heel;
    const Eigen::Vector3d sideways = above.cross(forward).normalized();
    foot.sideways = link_from_body.rotation * sideways;
    for (const std::size_t end : {kHeel, kToe}) {
      for (const auto& corner : corners[end]) {
        foot.ends[end].half_width = std::max(foot.ends[end].half_width,
                                             std::abs(sideways.dot(corner - mean(corners[end]))));
      }
    }
    foot.body_height = (heel - forward * forward.dot(heel)).norm();
    for (FitTask& task : model_.tasks) {
      if (task.link == foot.link) task.foot = static_cast<int>(model_.feet.size());
    }
    model_.is_foot[static_cast<std::size_t>(foot.link)] = 1;
    const int ankle = model_.links[static_cast<std::size_t>(foot.link)].parent;
    for (const int link : {foot.link, ankle}) {
      model_.foot_of_link[static_cast<std::size_t>(link)] = static_cast<int>(model_.feet.size());
    }
    model_.feet.push_back(foot);
  }
}

// a box is rounded by its thinnest side, at most by this much: its edges would be cut off too far
constexpr double kMaxRounding = 0.008;

void ModelMaker::add_floor_points(const CollisionShape& shape, const Frame& link_from_shape) {
  const int link = hanging_[static_cast<std::size_t>(shape.body)].link;
  auto& points = model_.floor_points[static_cast<std::size_t>(link)];
  const auto add = [&](const Eigen::Vector3d& in_shape, double radius) {
    points.push_back({link_from_shape * in_shape, radius});
    double& reach = model_.floor_reach[static_cast<std::size_t>(link)];
    reach = std::max(reach, points.back().position.norm() + radius);
  };
  switch (shape.type) {
    case CollisionShape::Type::kSphere:
      add(Eigen::Vector3d::Zero(), shape.radius);
      break;
    case CollisionShape::Type::kCapsule:
      add({0.0, 0.0, shape.half_length}, shape.radius);
      add({0.0, 0.0, -shape.half_length}, shape.radius);
      break;
    case CollisionShape::Type::kBox:
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                                   (corner & 4) != 0 ? 1.0 : -1.0);
        add(shape.half_size.cwiseProduct(sign), 0.0);
      }
      break;
  }
}

// Fingers and other joints that carry neither a mapped body nor a sole stay where the robot's zero
// configuration has them: only smoothness and collisions would move them.
void ModelMaker::hold_unmapped_joints() {
  std::vector<bool> moves(model_.links.size(), false);
  const auto mark = [&](int link) {
    for (const int above : chain_to_root(link)) moves[static_cast<std::size_t>(above)] = true;
  };
  for (const auto& [used, tasks] : tables_.tables) {
    for (const MappedTask& task : tasks) {
      if (used && task.has_weight()) mark(hanging_[static_cast<std::size_t>(task.body)].link);
    }
  }
  for (const FitFoot& foot : model_.feet) mark(foot.link);
  const std::vector<double> zero = robot_.zero_configuration();
  for (std::size_t link = 1; link < model_.links.size(); ++link) {
    if (moves[link]) continue;
    double& lower = model_.lower[FitModel::kBaseDofs - 1 + link];
    double& upper = model_.upper[FitModel::kBaseDofs - 1 + link];
    const auto address = static_cast<std::size_t>(model_.links[link].qpos_address);
    lower = upper = std::max(lower, std::min(zero[address], upper));
  }
}

void ModelMaker::add_shapes() {
  model_.floor_points.resize(model_.links.size());
  model_.floor_reach.assign(model_.links.size(), 0.0);
  for (const CollisionShape& shape : robot_.collision_shapes()) {
    const Hanging& hanging = hanging_[static_cast<std::size_t>(shape.body)];
    if (hanging.link < 0) continue;
    const Frame link_from_body = to_frame(hanging.link_from_body);
    const Frame link_from_shape = to_frame(hanging.link_from_body * shape.body_from_shape);
    model_.shapes.push_back(
        {placed(rounded(shape, kMaxRounding), link_from_body.rotation, link_from_body.translation),
         hanging.link});
    shape_body_.push_back(shape.body);
    add_floor_points(shape, link_from_shape);
  }
}

// what of a foot's shapes belongs to its heel, and what to its toe
void ModelMaker::add_foot_shapes() {
  for (FitFoot& foot : model_.feet) {
    const Eigen::Vector3d forward = foot.ends[kToe].middle - foot.ends[kHeel].middle;
    const Eigen::Vector3d middle = 0.5 * (foot.ends[kToe].middle + foot.ends[kHeel].middle);
    for (const FloorPoint& point : model_.floor_points[static_cast<std::size_t>(foot.link)]) {
      const std::size_t end = forward.dot(point.position - middle) > 0.0 ? kToe : kHeel;
      foot.ends[end].shape_points.push_back(point);
    }
  }
}

// the link of the moving body that carries a link's body; a body may have several joints
int ModelMaker::body_above(int link) const {
  const int body = model_.links[static_cast<std::size_t>(link)].body;
  while (link >= 0 && model_.links[static_cast<std::size_t>(link)].body == body) {
    link = model_.links[static_cast<std::size_t>(link)].parent;
  }
  return link;
}

// all pairs but those of one link, of neighbours in the tree, and those whose contact is no fault
int ModelMaker::carrier(int link) const {
  const auto held = [&](int of) {
    const auto dof = static_cast<std::size_t>(FitModel::kBaseDofs - 1 + of);
    return model_.lower[dof] == model_.upper[dof];
  };
  while (link > 0 && held(link)) link = model_.links[static_cast<std::size_t>(link)].parent;
  return link;
}

void ModelMaker::add_pairs() {
  std::set<std::pair<int, int>> allowed;
  for (const auto& [a, b] : robot_.profile().allowed_self_contact) {
    allowed.insert({a, b});
    allowed.insert({b, a});
  }
  const int count = static_cast<int>(model_.shapes.size());
  for (int a = 0; a < count; ++a) {
    const int link_a = model_.shapes[static_cast<std::size_t>(a)].link;
    for (int b = a + 1; b < count; ++b) {
      const int link_b = model_.shapes[static_cast<std::size_t>(b)].link;
      // what is held has no say in whether it touches
      if (carrier(link_a) == carrier(link_b)) continue;
      if (body_above(link_a) == link_b || body_above(link_b) == link_a) continue;
      if (allowed.contains({shape_body_[static_cast<std::size_t>(a)],
                            shape_body_[static_cast<std::size_t>(b)]})) {
        continue;
      }
      model_.pairs.push_back({a, b});
    }
  }
}

// pairs of the same two links side by side, and a ball around each link's shapes: most links are
// far from each other
void ModelMaker::group_pairs() {
  const auto links = [&](const FitPair& pair) {
    return std::pair(model_.shapes[static_cast<std::size_t>(pair.a)].link,
                     model_.shapes[static_cast<std::size_t>(pair.b)].link);
  };
  std::ranges::stable_sort(model_.pairs, {}, links);
  for (std::uint32_t i = 0; i < model_.pairs.size(); ++i) {
    const auto [link_a, link_b] = links(model_.pairs[i]);
    if (i == 0 || links(model_.pairs[i - 1]) != std::pair(link_a, link_b)) {
      model_.pair_groups.push_back({link_a, link_b, i, i});
    }
    model_.pair_groups.back().end = i + 1;
  }
  model_.link_balls.resize(model_.links.size());
  for (std::size_t link = 0; link < model_.links.size(); ++link) {
    Eigen::AlignedBox3d box;
    for (const FloorPoint& point : model_.floor_points[link]) box.extend(point.position);
    if (box.isEmpty()) continue;
    ShapeBall& ball = model_.link_balls[link];
    ball.centre = box.center();
    for (const FloorPoint& point : model_.floor_points[link]) {
      ball.radius = std::max(ball.radius, (point.position - ball.centre).norm() + point.radius);
    }
  }
}

}  // namespace

FitModel make_fit_model(const Robot& robot, const ResolvedMapping& tables, const LimitSet& limits,
                        const BoneArray<int>& target_of_bone, const FitOptions& options,
                        const SourceSides& sides) {
  return ModelMaker(robot, tables, limits, target_of_bone, options, sides).make();
}

}  // namespace retarget
