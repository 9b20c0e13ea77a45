#include "robot/anatomy/branches.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

// Bodies at most this many joints apart in the tree may touch.
constexpr int kNeighbours = 2;
// A chain with at least this many joints may end at a fork.
constexpr std::size_t kWholeLimb = 4;

}  // namespace

std::vector<bool> bodies_with_shapes(const Robot& robot) {
  std::vector<bool> has_shape(robot.bodies().size(), false);
  for (const CollisionShape& shape : robot.collision_shapes()) has_shape[shape.body] = true;
  return has_shape;
}

std::vector<std::pair<int, int>> neighbours(const Robot& robot) {
  const KinematicTree& tree = robot.tree();
  const std::vector<bool> has_shape = bodies_with_shapes(robot);
  std::vector<std::pair<int, int>> pairs;
  // A link's shapes may be on bodies fixed to it.
  const auto add = [&](int above, int below) {
    pairs.emplace_back(above, below);
    const std::vector<int> lower = tree.rigid_group(below);
    for (const int a : tree.rigid_group(above)) {
      for (const int b : lower) {
        const bool is_link_pair = a == above && b == below;
        if (has_shape[a] && has_shape[b] && !is_link_pair) pairs.emplace_back(a, b);
      }
    }
  };
  for (int body = 1; body < static_cast<int>(robot.bodies().size()); ++body) {
    if (tree.carrier(body) != body) continue;
    int above = body;
    for (int i = 0; i < kNeighbours && above != robot.root_body(); ++i) {
      above = tree.carrier(robot.bodies()[above].parent);
      add(above, body);
    }
  }
  return pairs;
}

namespace {

// Returns the link that outweighs its siblings, which are then mere rods; nothing if none does.
std::optional<int> heaviest(const Robot& robot, const std::vector<int>& links) {
  constexpr double kOutweighs = 4.0;
  const auto mass = [&](int link) {
    return robot.model()->body_subtreemass[robot.tree().links()[link].body];
  };
  const int first = *std::ranges::max_element(links, {}, mass);
  double others = -mass(first);
  for (const int link : links) others += mass(link);
  return mass(first) > kOutweighs * others ? std::optional(first) : std::nullopt;
}

}  // namespace

std::vector<int> joint_chain(const Robot& robot, int first) {
  const KinematicTree& tree = robot.tree();
  std::vector<int> chain;
  for (int link = first;;) {
    if (tree.links()[link].slides) return chain;
    chain.push_back(tree.links()[link].joint);
    const std::vector<int> next = tree.children(link);
    if (next.empty()) return chain;
    const int most = *std::ranges::max_element(
        next, {}, [&](int child) { return tree.links()[child].last_descendant - child; });
    if (next.size() == 1 || chain.size() < kWholeLimb) {
      link = most;
      continue;
    }
    const auto heavy = heaviest(robot, next);
    if (!heavy) return chain;
    link = *heavy;
  }
}

std::optional<int> first_slide(const Robot& robot, int first) {
  const auto& links = robot.tree().links();
  for (int link = first; link <= links[first].last_descendant; ++link) {
    if (links[link].slides) return links[link].joint;
  }
  return std::nullopt;
}

namespace {

// Returns the farthest extent of the branch that begins with a joint.
double reach(const TreeState& posed, int joint) {
  const KinematicTree& tree = *posed.tree;
  const int first = tree.link_of_joint(joint);
  double farthest = 0.0;
  for (int link = first; link <= tree.links()[first].last_descendant; ++link) {
    for (const int body : tree.rigid_group(tree.links()[link].body)) {
      const Eigen::Vector3d place = posed.world_from_body(body).translation;
      farthest = std::max(farthest, (place - posed.anchor(joint)).norm());
    }
  }
  return farthest;
}

// Returns the deviation of two chains from mirror symmetry about the plane normal to `across`,
// relative to their size; nothing if they are not on opposite sides.
std::optional<double> asymmetry(const TreeState& posed, const std::vector<int>& first,
                                const std::vector<int>& second, const Eigen::Vector3d& across) {
  double size = 0.0;
  double worst = 0.0;
  double apart = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Eigen::Vector3d gap = posed.anchor(first[i]) - posed.anchor(second[i]);
    const double along = gap.dot(across);
    // Ignore offsets along the joint axis, because an anchor may be anywhere on it.
    const Eigen::Vector3d& axis = posed.axis(first[i]);
    const Eigen::Vector3d aside = gap - along * across;
    worst = std::max(worst, (aside - aside.dot(axis) * axis).norm());
    apart += along / static_cast<double>(first.size());
    size = std::max(size, (posed.anchor(first[i]) - posed.anchor(first[0])).norm());
  }
  if (!(size > 0.0)) size = reach(posed, first[0]);
  if (!(apart > 0.02 * size) || !(size > 0.0)) return std::nullopt;
  return worst / size;
}

// Covers all joints of a branch, including those beyond the end of its chain.
double lowest_joint(const TreeState& posed, int first) {
  const auto& links = posed.tree->links();
  double lowest = posed.anchor(links[first].joint).z();
  for (int link = first; link <= links[first].last_descendant; ++link) {
    lowest = std::min(lowest, posed.anchor(links[link].joint).z());
  }
  return lowest;
}

// Returns the horizontal unit vector from one chain to the other; zero if one is directly above the
// other. An anchor may be anywhere on its joint's axis, so the vector comes from the distances
// between parallel axes where there are any (hips that roll or turn, but not knees).
Eigen::Vector3d level_way(const TreeState& posed, const std::vector<int>& to,
                          const std::vector<int>& from) {
  constexpr double kParallel = 0.99;  // Cosine.
  constexpr double kLeast = 0.02;     // Fraction of the distance between the anchors.
  Eigen::Vector3d between_anchors = Eigen::Vector3d::Zero();
  Eigen::Vector3d between_axes = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < to.size(); ++i) {
    Eigen::Vector3d gap = posed.anchor(to[i]) - posed.anchor(from[i]);
    gap.z() = 0.0;
    between_anchors += gap;
    // In the mean of both axes, mirrored slants cancel.
    const Eigen::Vector3d& other = posed.axis(from[i]);
    const double alike = posed.axis(to[i]).dot(other);
    if (std::abs(alike) < kParallel) continue;
    const Eigen::Vector3d axis =
        (posed.axis(to[i]) + std::copysign(1.0, alike) * other).normalized();
    Eigen::Vector3d level(axis.x(), axis.y(), 0.0);
    level = level.norm() > kLeast ? level.normalized() : Eigen::Vector3d(Eigen::Vector3d::Zero());
    between_axes += gap - gap.dot(level) * level;
  }
  const bool known = between_axes.norm() > kLeast * between_anchors.norm();
  return (known ? between_axes : between_anchors).stableNormalized();
}

// Returns the common part of two chains that end differently: up to the last fork of either, beyond
// which a chain may follow any finger. Returns nothing if neither forks.
std::optional<std::size_t> length_to_fork(const Robot& robot, const std::vector<int>& a,
                                          const std::vector<int>& b) {
  const KinematicTree& tree = robot.tree();
  const auto forks = [&](int joint) { return tree.children(tree.link_of_joint(joint)).size() > 1; };
  for (std::size_t length = std::min(a.size(), b.size()); length >= kWholeLimb; --length) {
    if (forks(a[length - 1]) || forks(b[length - 1])) return length;
  }
  return std::nullopt;
}

// Mirror relation of two chains.
struct Mirroring {
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
  bool swapped = false;  // Whether `across` points to the second chain.
};

std::optional<Mirroring> mirroring_of(const TreeState& posed, const std::vector<int>& a,
                                      const std::vector<int>& b) {
  constexpr double kMirrored = 0.25;
  constexpr double kAslant = 0.1;  // Sine of the angle to the axes: 6 degrees.
  constexpr double kClearer = 0.3;
  std::optional<Mirroring> best;
  double min = kMirrored;
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0), level_way(posed, a, b)}) {
    // A model that does not face along an axis is unusual, so it must be clearly more symmetric.
    const bool oblique = std::abs(axis.x()) > kAslant && std::abs(axis.y()) > kAslant;
    if (!oblique && axis.cwiseAbs().maxCoeff() < 1.0) continue;
    for (const double sign : {1.0, -1.0}) {
      const auto found = asymmetry(posed, a, b, sign * axis);
      if (!found || !(*found < (oblique ? std::min(kMirrored, kClearer * min) : min))) continue;
      min = *found;
      best = Mirroring{axis, sign < 0.0};
    }
  }
  return best;
}

std::optional<BranchPair> pair_of(const Robot& robot, const TreeState& posed, int first,
                                  int second) {
  std::vector<int> a = joint_chain(robot, first);
  std::vector<int> b = joint_chain(robot, second);
  if (std::min(a.size(), b.size()) < 2) return std::nullopt;
  auto mirroring = a.size() == b.size() ? mirroring_of(posed, a, b) : std::nullopt;
  if (!mirroring) {
    const auto common = length_to_fork(robot, a, b);
    if (!common) return std::nullopt;
    a.resize(*common);
    b.resize(*common);
    mirroring = mirroring_of(posed, a, b);
    if (!mirroring) return std::nullopt;
  }
  BranchPair pair{0,
                  first,
                  second,
                  mirroring->across,
                  std::min(lowest_joint(posed, first), lowest_joint(posed, second)),
                  static_cast<int>(a.size())};
  if (mirroring->swapped) std::swap(pair.first, pair.second);
  return pair;
}

void collect_pairs(const Robot& robot, const TreeState& posed, int trunk,
                   std::vector<BranchPair>& pairs) {
  std::vector<int> rest = posed.tree->children(trunk);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t k = i + 1; k < rest.size(); ++k) {
      auto pair = pair_of(robot, posed, rest[i], rest[k]);
      if (!pair) continue;
      pair->parent = trunk;
      pairs.push_back(*pair);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      --i;
      break;
    }
  }
  for (const int child : rest) collect_pairs(robot, posed, child, pairs);
}

}  // namespace

std::vector<int> joint_chain(const Robot& robot, const BranchPair& pair, int first) {
  std::vector<int> chain = joint_chain(robot, first);
  chain.resize(std::min(chain.size(), static_cast<std::size_t>(pair.joint_count)));
  return chain;
}

std::vector<BranchPair> branch_pairs(const Robot& robot, const TreeState& posed) {
  std::vector<BranchPair> pairs;
  collect_pairs(robot, posed, 0, pairs);
  return pairs;
}

namespace {

constexpr std::size_t kLimb = 3;  // Joints of a limb at least.
// Distance of a limb from the middle, as a fraction of the distance between the limbs of a pair.
constexpr double kLeastAside = 0.1;
constexpr const char* kCompleteSides =
    "add it to the model, or remove the joints that only one side has";

class CounterpartSearch {
 public:
  CounterpartSearch(const Robot& robot, const TreeState& posed,
                    const std::vector<BranchPair>& pairs)
      : robot_(robot), tree_(robot.tree()), posed_(posed), pairs_(pairs) {}

  // Looks at the branches of a trunk link, then beyond those that carry pairs.
  [[nodiscard]] std::optional<OneSided> below(int trunk) const;

 private:
  [[nodiscard]] bool is_paired(int link) const {
    return std::ranges::any_of(
        pairs_, [&](const BranchPair& pair) { return pair.first == link || pair.second == link; });
  }
  [[nodiscard]] bool carries_pair(int link) const {
    return std::ranges::any_of(
        pairs_, [&](const BranchPair& pair) { return tree_.carries(link, pair.first); });
  }
  [[nodiscard]] std::string name_of(int joint) const {
    return "\"" + robot_.joints()[joint].name + "\"";
  }
  [[nodiscard]] bool may_be_limb(int link) const;
  [[nodiscard]] double aside(int link) const;
  [[nodiscard]] std::optional<OneSided> differing(int first, int second) const;
  [[nodiscard]] std::optional<OneSided> posed_differently(int first, int second) const;
  [[nodiscard]] std::optional<OneSided> alone(int link) const;

  const Robot& robot_;
  const KinematicTree& tree_;
  const TreeState& posed_;
  const std::vector<BranchPair>& pairs_;
};

// Two branches whose joints mirror each other until one of them is missing.
std::optional<OneSided> CounterpartSearch::differing(int first, int second) const {
  constexpr double kApart = 0.15;  // Fraction of the limb's extent.
  constexpr double kAlike = 0.9;   // Cosine of the angle between two axes.
  std::vector<int> longer = joint_chain(robot_, first), shorter = joint_chain(robot_, second);
  if (longer.size() < shorter.size()) std::swap(longer, shorter);
  if (longer.size() == shorter.size() || shorter.size() < kLimb) return std::nullopt;
  Eigen::Vector3d across = posed_.anchor(longer[0]) - posed_.anchor(shorter[0]);
  across.z() = 0.0;
  const double extent = (posed_.anchor(longer.back()) - posed_.anchor(longer[0])).norm();
  if (!(across.norm() > 0.0)) return std::nullopt;
  across.normalize();
  const Eigen::Vector3d middle = 0.5 * (posed_.anchor(longer[0]) + posed_.anchor(shorter[0]));
  const auto mirrored = [&](const Eigen::Vector3d& way) -> Eigen::Vector3d {
    return way - 2.0 * way.dot(across) * across;
  };
  const auto match = [&](int joint, int other) {
    const Eigen::Vector3d place = middle + mirrored(posed_.anchor(joint) - middle);
    const double alike = std::abs(mirrored(posed_.axis(joint)).dot(posed_.axis(other)));
    return (place - posed_.anchor(other)).norm() < kApart * extent && alike > kAlike;
  };
  std::vector<int> missing;
  std::size_t next = 0;
  for (const int joint : longer) {
    if (next < shorter.size() && match(joint, shorter[next])) {
      ++next;
    } else {
      missing.push_back(joint);
    }
  }
  if (next < shorter.size() || missing.size() + kLimb > longer.size()) return std::nullopt;
  return OneSided{
      fmt::format("the limbs starting at {} and {} have {} and {} joints: {} has no counterpart",
                  name_of(longer[0]), name_of(shorter[0]), longer.size(), shorter.size(),
                  name_of(missing.front())),
      kCompleteSides};
}

bool CounterpartSearch::may_be_limb(int link) const {
  return joint_chain(robot_, link).size() >= kLimb && !carries_pair(link);
}

// Returns the position of a branch across the trunk, relative to the distance between the limbs of
// a pair; 0 is the middle.
double CounterpartSearch::aside(int link) const {
  if (pairs_.empty()) return 0.0;
  const BranchPair& pair = pairs_.front();
  const auto place = [&](int first) { return posed_.anchor(tree_.links()[first].joint); };
  const Eigen::Vector3d middle = 0.5 * (place(pair.first) + place(pair.second));
  const double width = (place(pair.first) - place(pair.second)).dot(pair.across);
  return (place(link) - middle).dot(pair.across) / std::abs(width);
}

// Two branches with the same joints on opposite sides that are not mirror images.
std::optional<OneSided> CounterpartSearch::posed_differently(int first, int second) const {
  const std::vector<int> a = joint_chain(robot_, first), b = joint_chain(robot_, second);
  if (a.size() != b.size() || !may_be_limb(first) || !may_be_limb(second)) return std::nullopt;
  const auto [left, right] = std::minmax({aside(first), aside(second)});
  if (left > -kLeastAside || right < kLeastAside) return std::nullopt;
  return OneSided{
      fmt::format("the limbs starting at {} and {} have the same number of joints but do "
                  "not mirror each other in the zero configuration",
                  name_of(a[0]), name_of(b[0])),
      "give one side the mirrored zero pose of the other, and adapt its joint ranges"};
}

// A branch beside the trunk.
std::optional<OneSided> CounterpartSearch::alone(int link) const {
  if (!may_be_limb(link) || std::abs(aside(link)) < kLeastAside) return std::nullopt;
  return OneSided{fmt::format("the limb starting at {} has no counterpart on the other side",
                              name_of(tree_.links()[link].joint)),
                  kCompleteSides};
}

std::optional<OneSided> CounterpartSearch::below(int trunk) const {
  std::vector<int> rest;
  for (const int child : tree_.children(trunk)) {
    if (!is_paired(child)) rest.push_back(child);
  }
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t k = i + 1; k < rest.size(); ++k) {
      if (auto found = differing(rest[i], rest[k])) return found;
      if (auto found = posed_differently(rest[i], rest[k])) return found;
    }
  }
  for (const int child : rest) {
    if (auto found = alone(child)) return found;
    if (auto found = below(child)) return found;
  }
  return std::nullopt;
}

}  // namespace

std::optional<OneSided> missing_counterpart(const Robot& robot, const TreeState& posed,
                                            const std::vector<BranchPair>& pairs) {
  return CounterpartSearch(robot, posed, pairs).below(0);
}

}  // namespace retarget
