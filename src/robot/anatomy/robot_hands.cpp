#include "robot/anatomy/robot_hands.h"

#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "retarget/shape_distance.h"
#include "robot/anatomy/finger_names.h"

namespace retarget {
namespace {

class HandFinder {
 public:
  HandFinder(const Robot& robot, const Limb& arm, Side side)
      : robot_(robot),
        tree_(robot.tree()),
        posed_(robot.tree(), reference_configuration(robot)),
        palm_(tree_.link_of_joint(arm.joints.back())) {
    hand_.side = side;
  }

  std::optional<RobotHand> find();

 private:
  struct Branch {
    RobotFinger finger;
    std::optional<Finger> named;
    // Knuckle position and vector from knuckle to tip, in the palm link.
    Eigen::Vector3d base = Eigen::Vector3d::Zero(), way = Eigen::Vector3d::Zero();
    double reach = 0.0;  // Length along the joints to the tip.
  };

  void add_joints();
  void couple();
  [[nodiscard]] bool is_held(int joint) const;
  [[nodiscard]] std::vector<int> path_to_end(int first) const;
  [[nodiscard]] Branch branch(int first) const;
  void find_tip(int link, const Eigen::Vector3d& before, RobotFinger& finger) const;
  bool name_fingers();
  void name_by_shape();
  void find_palm_axes();
  [[nodiscard]] double opening() const;
  [[nodiscard]] Eigen::Vector3d closing(const RobotFinger& finger) const;
  [[nodiscard]] int hand_index(int link) const { return link - palm_ - 1; }
  [[nodiscard]] Eigen::Vector3d in_palm(const Eigen::Vector3d& world) const {
    return posed_.world_from_link[palm_].inverse() * world;
  }
  [[nodiscard]] Eigen::Vector3d joint_in_palm(int hand_joint) const {
    return in_palm(posed_.world_from_link[palm_ + 1 + hand_joint].translation);
  }
  [[nodiscard]] Eigen::Vector3d tip_in_palm(const RobotFinger& finger) const {
    return in_palm(posed_.world_from_link[palm_ + 1 + finger.joints.back()] * finger.tip);
  }

  const Robot& robot_;
  const KinematicTree& tree_;
  TreeState posed_;
  int palm_;
  RobotHand hand_;
  std::vector<Branch> branches_;
};

bool HandFinder::is_held(int joint) const {
  return robot_.variant().locked.contains(robot_.joints()[joint].name);
}

// A subtree's links are contiguous, parents first.
void HandFinder::add_joints() {
  for (int link = palm_ + 1; link <= tree_.links()[palm_].last_descendant; ++link) {
    const KinematicTree::Link& from = tree_.links()[link];
    HandJoint joint;
    joint.joint = from.joint;
    joint.parent = from.parent == palm_ ? -1 : hand_index(from.parent);
    joint.parent_from_joint = from.parent_from_link;
    joint.slides = from.slides;
    joint.reference = from.reference;
    hand_.joints.push_back(joint);
  }
}

// Follows each joint's chain of leaders up to a joint that moves freely.
void HandFinder::couple() {
  const auto& couplings = robot_.profile().coupled_joints;
  std::vector<int> variable_of(robot_.joints().size(), -1);
  for (const HandJoint& joint : hand_.joints) {
    if (couplings.contains(robot_.joints()[joint.joint].name)) continue;
    variable_of[joint.joint] = static_cast<int>(hand_.variables.size());
    hand_.variables.push_back(joint.joint);
  }
  for (HandJoint& joint : hand_.joints) {
    int leader = joint.joint;
    // The bound ends the loop if the couplings form a cycle.
    for (std::size_t i = 0; variable_of[leader] < 0 && i < hand_.joints.size(); ++i) {
      const JointCoupling& coupling = couplings.at(robot_.joints()[leader].name);
      const auto next = robot_.find_joint(coupling.leader);
      if (!next) break;
      joint.offset += joint.ratio * coupling.offset;
      joint.ratio *= coupling.ratio;
      leader = *next;
      if (variable_of[leader] < 0 && !couplings.contains(robot_.joints()[leader].name)) break;
    }
    if (variable_of[leader] < 0) {
      // The leader is outside the hand or does not exist, so the joint moves freely.
      joint.ratio = 1.0;
      joint.offset = 0.0;
      leader = joint.joint;
      variable_of[leader] = static_cast<int>(hand_.variables.size());
      hand_.variables.push_back(leader);
    }
    joint.variable = variable_of[leader];
  }
}

// Returns the path through a subtree with the most joints.
std::vector<int> HandFinder::path_to_end(int first) const {
  const auto depth = [&](const auto& self, int link) -> int {
    int most = 0;
    for (const int child : tree_.children(link)) most = std::max(most, self(self, child));
    return most + 1;
  };
  std::vector<int> path = {first};
  for (std::vector<int> next = tree_.children(first); !next.empty();
       next = tree_.children(path.back())) {
    path.push_back(
        *std::ranges::max_element(next, {}, [&](int child) { return depth(depth, child); }));
  }
  return path;
}

// Finds the end of the last link: from its shapes, from bodies fixed to it (many models have a tip
// body), from its mass; otherwise the link is as long as the one before it.
void HandFinder::find_tip(int link, const Eigen::Vector3d& before, RobotFinger& finger) const {
  const std::vector<int> bodies = tree_.rigid_group(tree_.links()[link].body);
  const auto is_of_link = [&](int body) { return std::ranges::find(bodies, body) != bodies.end(); };
  double farthest = 0.0;
  const auto take = [&](const Eigen::Vector3d& point, double radius) {
    if (point.norm() + radius <= farthest) return;
    farthest = point.norm() + radius;
    finger.tip = point;
    finger.tip_radius = radius;
  };
  for (const CollisionShape& shape : robot_.collision_shapes()) {
    if (!is_of_link(shape.body)) continue;
    const Pose link_from_shape =
        tree_.attachment(shape.body).link_from_body * shape.body_from_shape;
    if (shape.type == CollisionShape::Type::kBox) {
      int along = 0;
      shape.half_size.maxCoeff(&along);
      const double radius = shape.half_size.minCoeff();
      Eigen::Vector3d end = Eigen::Vector3d::Zero();
      end[along] = shape.half_size[along] - radius;
      take(link_from_shape * end, radius);
      take(link_from_shape * Eigen::Vector3d(-end), radius);
      continue;
    }
    for (const Eigen::Vector3d& point : core_points(shape)) {
      take(tree_.attachment(shape.body).link_from_body * point, shape.radius);
    }
  }
  if (farthest > 0.0) return;
  for (const int body : bodies) {
    take(tree_.attachment(body).link_from_body.translation, 0.0);
  }
  if (farthest > 1e-3) return;
  const int body = tree_.links()[link].body;
  const Eigen::Vector3d mass =
      tree_.attachment(body).link_from_body *
      Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(robot_.model()->body_ipos + 3 * body));
  take(2.0 * mass, 0.0);
  if (farthest > 1e-3) return;
  finger.tip = before;
}

HandFinder::Branch HandFinder::branch(int first) const {
  constexpr double kSamePlace = 0.1;  // Fraction of the finger's length.
  constexpr double kAlike = 0.7;      // Cosine of the angle between two axes.
  Branch found;
  RobotFinger& finger = found.finger;
  const std::vector<int> path = path_to_end(first);
  std::vector<Eigen::Vector3d> points;
  for (const int link : path) {
    finger.joints.push_back(hand_index(link));
    points.push_back(joint_in_palm(hand_index(link)));
    const RobotJoint& joint = robot_.joints()[tree_.links()[link].joint];
    // Bodies first: renaming one does not change the columns of motions.
    for (const std::string* name : {&robot_.bodies()[joint.body].name, &joint.name}) {
      if (!found.named) found.named = finger_of_name(*name);
    }
  }
  const Pose palm_from_last =
      posed_.world_from_link[palm_].inverse() * posed_.world_from_link[path.back()];
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  if (points.size() > 1) {
    before = palm_from_last.rotation.conjugate() * (points.back() - points[points.size() - 2]);
  }
  find_tip(path.back(), before, finger);
  points.push_back(tip_in_palm(finger));
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  // Joints at the same position form one corner. A joint that turns a finger sideways between two
  // that bend it is not a corner: its offset from the knuckle is not a phalanx.
  const Eigen::Vector3d& bend = posed_.axis(tree_.links()[path.back()].joint);
  std::size_t last = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const bool near_tip = (points.back() - points[i]).norm() < kSamePlace * length;
    const bool same = i > 0 && (points[i] - points[last]).norm() < kSamePlace * length;
    const bool aside = std::abs(posed_.axis(tree_.links()[path[i]].joint).dot(bend)) < kAlike;
    if (i > 0 && (same || near_tip || aside)) continue;
    if (i > 0) finger.length += (points[i] - points[last]).norm();
    last = i;
    finger.corners.push_back(finger.joints[i]);
  }
  finger.length += (points.back() - points[last]).norm();
  found.base = points.front();
  found.way = points.back() - points.front();
  found.reach = length;
  return found;
}

// Returns true if names identify all branches. Of branches with the same name the longest one is
// the finger.
bool HandFinder::name_fingers() {
  std::ranges::stable_sort(branches_, [](const Branch& a, const Branch& b) {
    return a.finger.joints.size() > b.finger.joints.size();
  });
  std::vector<Branch> named;
  for (const Branch& branch : branches_) {
    if (!branch.named) continue;
    const bool is_there = std::ranges::any_of(
        named, [&](const Branch& other) { return other.named == branch.named; });
    if (!is_there) named.push_back(branch);
  }
  if (named.size() < 2) return false;
  branches_ = std::move(named);
  for (Branch& branch : branches_) {
    branch.finger.finger = *branch.named;
    branch.finger.is_named = true;
  }
  return true;
}

// The thumb is the only branch with its name. Otherwise, it points away from the other fingers or
// begins behind them. The others follow in order from its side.
void HandFinder::name_by_shape() {
  const auto distinctness = [&](const Branch& branch) {
    Eigen::Vector3d way = Eigen::Vector3d::Zero(), base = Eigen::Vector3d::Zero();
    for (const Branch& other : branches_) {
      if (&other == &branch) continue;
      way += other.way.normalized();
      base += other.base / static_cast<double>(branches_.size() - 1);
    }
    way.normalize();
    return 1.0 - branch.way.normalized().dot(way) +
           std::max(0.0, way.dot(base - branch.base)) / branch.reach;
  };
  std::vector<double> odd;
  for (const Branch& branch : branches_) odd.push_back(distinctness(branch));
  const auto is_named = [](const Branch& branch) { return branch.named == Finger::kThumb; };
  const auto named = std::ranges::find_if(branches_, is_named);
  const bool thumb_is_named = std::ranges::count_if(branches_, is_named) == 1;
  const auto thumb =
      thumb_is_named ? named - branches_.begin() : std::ranges::max_element(odd) - odd.begin();
  std::swap(branches_.front(), branches_[static_cast<std::size_t>(thumb)]);
  branches_.front().finger.finger = Finger::kThumb;
  branches_.front().finger.is_named = thumb_is_named;
  // Order the others along the row of knuckles, starting with the nearest to the thumb.
  const Eigen::Vector3d thumb_base = branches_.front().base + 0.5 * branches_.front().way;
  const std::vector<Branch> others(branches_.begin() + 1, branches_.end());
  const auto first = std::ranges::min_element(
      others, {}, [&](const Branch& b) { return (b.base - thumb_base).norm(); });
  const Eigen::Vector3d from = first->base;
  std::sort(branches_.begin() + 1, branches_.end(), [&](const Branch& a, const Branch& b) {
    return (a.base - from).norm() < (b.base - from).norm();
  });
  for (std::size_t i = 1; i < branches_.size(); ++i) {
    branches_[i].finger.finger = kFingers[i];
  }
}

// Returns the direction in which the tip moves when the finger closes: the side with more joint
// range.
Eigen::Vector3d HandFinder::closing(const RobotFinger& finger) const {
  const LimitSet& limits = robot_.model_limits();
  const Eigen::Vector3d tip = posed_.world_from_link[palm_ + 1 + finger.joints.back()] * finger.tip;
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (const int index : finger.joints) {
    const HandJoint& joint = hand_.joints[index];
    const double lower = limits.lower[joint.joint], upper = limits.upper[joint.joint];
    const double range = upper - lower;
    if (joint.slides || !(range > 0.0) || !std::isfinite(range)) continue;
    const double share = (upper + lower) / range;
    const Eigen::Vector3d velocity =
        posed_.axis(joint.joint).cross(tip - posed_.anchor(joint.joint));
    way += std::clamp(share, -1.0, 1.0) * velocity;
  }
  return posed_.world_from_link[palm_].rotation.conjugate() * way;
}

void HandFinder::find_palm_axes() {
  Eigen::Vector3d forward = Eigen::Vector3d::Zero(), out = Eigen::Vector3d::Zero();
  for (const RobotFinger& finger : hand_.fingers) {
    if (finger.finger == Finger::kThumb) continue;
    forward += (tip_in_palm(finger) - joint_in_palm(finger.joints.front())).normalized();
    out += closing(finger);
  }
  const RobotFinger* thumb = hand_.find(Finger::kThumb);
  const auto odd = [&](const Eigen::Vector3d& axis) {
    return !(axis.norm() > 1e-6) || axis.cross(forward).norm() < 1e-3 * axis.norm();
  };
  if (odd(out) && thumb != nullptr) {
    // Fingers with symmetric ranges close towards the thumb.
    out = tip_in_palm(*thumb) - tip_in_palm(hand_.fingers.back());
  }
  if (odd(out)) out = forward.unitOrthogonal();
  forward.normalize();
  out = (out - out.dot(forward) * forward).normalized();
  const double side = hand_.side == Side::kLeft ? 1.0 : -1.0;
  hand_.palm_axes << forward, side * out.cross(forward), out;
}

// Tries all motors at either end of their range and keeps the widest opening.
double HandFinder::opening() const {
  constexpr std::size_t kMostMotors = 6;
  const LimitSet& limits = robot_.model_limits();
  double widest = 0.0;
  const std::size_t motors = std::min(hand_.variables.size(), kMostMotors);
  for (std::size_t ends = 0; ends < (std::size_t{1} << motors); ++ends) {
    std::vector<double> qpos = robot_.zero_configuration();
    for (const HandJoint& joint : hand_.joints) {
      const auto variable = static_cast<std::size_t>(joint.variable);
      const int leader = hand_.variables[variable];
      const bool upper = variable < motors && ((ends >> variable) & 1U) != 0;
      const double end = upper ? limits.upper[leader] : limits.lower[leader];
      if (!std::isfinite(end)) return 0.0;
      qpos[robot_.joints()[joint.joint].qpos_address] = joint.ratio * end + joint.offset;
    }
    const TreeState state(tree_, qpos);
    const auto tip = [&](const RobotFinger& finger) -> Eigen::Vector3d {
      return state.world_from_link[palm_ + 1 + finger.joints.back()] * finger.tip;
    };
    const RobotFinger &a = hand_.fingers.front(), &b = hand_.fingers.back();
    widest = std::max(widest, (tip(a) - tip(b)).norm() - a.tip_radius - b.tip_radius);
  }
  return widest;
}

std::optional<RobotHand> HandFinder::find() {
  constexpr double kShortest = 0.4;  // Fraction of the longest finger: shorter branches are not
                                     // fingers.
  const std::vector<int> children = tree_.children(palm_);
  if (children.size() < 2) return std::nullopt;
  hand_.palm_body = tree_.links()[palm_].body;
  add_joints();
  if (std::ranges::any_of(hand_.joints, [&](const HandJoint& j) { return is_held(j.joint); })) {
    return std::nullopt;
  }
  couple();
  for (const int child : children) branches_.push_back(branch(child));
  const double longest = std::ranges::max_element(branches_, {}, &Branch::reach)->reach;
  std::erase_if(branches_, [&](const Branch& b) { return !(b.reach > kShortest * longest); });
  if (branches_.size() < 2) return std::nullopt;
  if (!name_fingers()) {
    if (branches_.size() > kFingerCount) return std::nullopt;
    hand_.is_gripper = branches_.size() == 2;
    name_by_shape();
  }
  std::ranges::sort(branches_, {}, [](const Branch& b) { return b.finger.finger; });
  for (Branch& branch : branches_) hand_.fingers.push_back(std::move(branch.finger));
  const bool thumb_alone =
      hand_.fingers.size() == 1 && hand_.fingers.front().finger == Finger::kThumb;
  if (thumb_alone) return std::nullopt;
  find_palm_axes();
  if (hand_.is_gripper) hand_.opening = opening();
  return std::move(hand_);
}

}  // namespace

const RobotFinger* RobotHand::find(Finger finger) const {
  const auto found = std::ranges::find(fingers, finger, &RobotFinger::finger);
  return found == fingers.end() ? nullptr : &*found;
}

RobotHands find_hands(const Robot& robot, const RobotAnatomy& anatomy) {
  RobotHands hands;
  for (std::size_t side = 0; side < hands.size(); ++side) {
    hands[side] = HandFinder(robot, anatomy.arms[side], kSides[side]).find();
  }
  return hands;
}

RobotHands find_hands(const Robot& robot) {
  const auto anatomy = find_limbs(robot, robot.name());
  return anatomy ? find_hands(robot, *anatomy) : RobotHands();
}

}  // namespace retarget
