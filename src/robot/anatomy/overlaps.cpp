#include "robot/anatomy/overlaps.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "retarget/kinematic_tree.h"
#include "retarget/shape_distance.h"
#include "robot/anatomy/branches.h"
#include "robot/model/collision.h"

namespace retarget {
namespace {

class BodyMirror {
 public:
  BodyMirror(const Robot& robot, const RobotAnatomy& limbs)
      : tree_(robot.tree()),
        posed_(robot.tree(), reference_configuration(robot)),
        left_(limbs.left),
        has_shape_(bodies_with_shapes(robot)),
        images_(robot.bodies().size(), -1) {
    const auto root = [&](std::size_t side) {
      return posed_.anchor(limbs.arms[side].joints.front());
    };
    middle_ = 0.5 * (root(0) + root(1));
  }

  std::vector<int> find(const RobotAnatomy& limbs);

 private:
  // Returns the candidate nearest to the mirror image of a point; nothing without candidates.
  template <typename Place>
  [[nodiscard]] std::optional<int> nearest(const Eigen::Vector3d& point,
                                           std::span<const int> candidates,
                                           const Place& place) const {
    const Eigen::Vector3d image = point - 2.0 * left_.dot(point - middle_) * left_;
    const auto apart = [&](int candidate) { return (place(candidate) - image).norm(); };
    if (candidates.empty()) return std::nullopt;
    return *std::ranges::min_element(candidates, {}, apart);
  }

  void mirror_group(const std::vector<int>& bodies, const std::vector<int>& others);
  void mirror_links(int first, int second);

  const KinematicTree& tree_;
  TreeState posed_;
  Eigen::Vector3d left_, middle_;
  std::vector<bool> has_shape_;
  std::vector<int> images_;
};

void BodyMirror::mirror_group(const std::vector<int>& bodies, const std::vector<int>& others) {
  const auto place = [&](int body) { return posed_.world_from_body(body).translation; };
  // Of bodies at one place, the one with shapes mirrors the one with shapes.
  std::vector<int> shaped_first = others;
  std::stable_partition(shaped_first.begin(), shaped_first.end(),
                        [&](int body) { return has_shape_[body]; });
  for (const int body : bodies) {
    const auto image = nearest(place(body), has_shape_[body] ? shaped_first : others, place);
    if (image) images_[body] = *image;
  }
}

// Mirrors two links and the bodies fixed to them; bodies without a counterpart keep none.
void BodyMirror::mirror_links(int first, int second) {
  const auto group = [&](int link) { return tree_.rigid_group(tree_.links()[link].body); };
  mirror_group(group(first), group(second));
  mirror_group(group(second), group(first));
  images_[tree_.links()[first].body] = tree_.links()[second].body;
  images_[tree_.links()[second].body] = tree_.links()[first].body;
  const auto anchor = [&](int link) { return posed_.anchor(tree_.links()[link].joint); };
  const std::vector<int> own = tree_.children(first), others = tree_.children(second);
  for (const int child : own) {
    const auto other = nearest(anchor(child), others, anchor);
    if (other && nearest(anchor(*other), own, anchor) == child) mirror_links(child, *other);
  }
}

std::vector<int> BodyMirror::find(const RobotAnatomy& limbs) {
  std::vector<bool> in_limb(tree_.links().size(), false);
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    for (const Limb& limb : *pair) {
      if (limb.joints.empty()) continue;
      const int first = tree_.link_of_joint(limb.joints.front());
      std::fill(in_limb.begin() + first, in_limb.begin() + tree_.links()[first].last_descendant + 1,
                true);
    }
    if ((*pair)[0].joints.empty()) continue;
    mirror_links(tree_.link_of_joint((*pair)[0].joints.front()),
                 tree_.link_of_joint((*pair)[1].joints.front()));
  }
  for (std::size_t link = 0; link < tree_.links().size(); ++link) {
    if (in_limb[link]) continue;
    const std::vector<int> bodies = tree_.rigid_group(tree_.links()[link].body);
    mirror_group(bodies, bodies);
  }
  return images_;
}

// Returns the mirror image of every body: the body at the same place of the other limb, or of the
// other side of the trunk; the body itself in the middle of the trunk; -1 if there is none. Names
// do not matter.
std::vector<int> mirrored_bodies(const Robot& robot, const RobotAnatomy& limbs) {
  return BodyMirror(robot, limbs).find(limbs);
}

using BodyPair = std::pair<int, int>;

BodyPair ordered(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

constexpr int kSamples = 1024;
constexpr double kTouching = 1e-3;  // Metres: shallower overlaps are rounding errors.
constexpr double kAlways = 0.9;     // Fraction of the samples.
// Fraction of the samples for forearms and hands: a hanging arm is free in nearly all other poses.
constexpr double kOften = 0.1;

std::vector<int> first_primes(std::size_t count) {
  std::vector<int> primes;
  for (int number = 2; primes.size() < count; ++number) {
    const auto divides = [number](int prime) { return number % prime == 0; };
    if (std::ranges::none_of(primes, divides)) primes.push_back(number);
  }
  return primes;
}

struct Interval {
  double lower = 0.0, upper = 0.0;
};

// Samples an unlimited hinge over a full turn and an unlimited slide over 1 m, or over half of that
// from its limit if it has one.
Interval sampled_range(const Robot& robot, std::size_t joint) {
  const bool slides = robot.joints()[joint].type == RobotJoint::Type::kSlide;
  const double reach = slides ? 0.5 : std::numbers::pi;
  const double lower = robot.model_limits().lower[joint];
  const double upper = robot.model_limits().upper[joint];
  if (std::isfinite(lower) && std::isfinite(upper)) return {lower, upper};
  if (std::isfinite(lower)) return {lower, lower + reach};
  if (std::isfinite(upper)) return {upper - reach, upper};
  return {-reach, reach};
}

// Penetration depths of touching body pairs.
class OverlapMeter {
 public:
  explicit OverlapMeter(const Robot& robot)
      : robot_(robot),
        collision_(robot),
        world_from_body_(robot.bodies().size()),
        placed_(collision_.shapes().size()) {}

  const std::map<BodyPair, double>& measure(std::span<const double> qpos) {
    depths_.clear();
    forward_kinematics(robot_, qpos, world_from_body_);
    collision_.place(world_from_body_, placed_);
    collision_.near_pairs(placed_, 0.0, near_);
    for (const ShapePair& pair : near_) {
      const double depth = -shape_distance(placed_[pair.a], placed_[pair.b]).distance;
      if (depth <= kTouching) continue;
      const auto bodies =
          std::minmax(collision_.shapes()[pair.a].body, collision_.shapes()[pair.b].body);
      double& deepest = depths_[bodies];
      deepest = std::max(deepest, depth);
    }
    return depths_;
  }

 private:
  const Robot& robot_;
  const CollisionModel collision_;
  std::vector<Pose> world_from_body_;
  std::vector<RoundedShape> placed_;
  std::vector<ShapePair> near_;
  std::map<BodyPair, double> depths_;
};

// By body: true for forearms and everything that they carry.
std::vector<bool> beyond_elbows(const Robot& robot, const RobotAnatomy& limbs) {
  std::vector<bool> beyond(robot.bodies().size(), false);
  for (const Limb& arm : limbs.arms) {
    beyond[static_cast<std::size_t>(robot.joints()[arm.joints[arm.middle]].body)] = true;
  }
  // Parents precede children.
  for (std::size_t body = 1; body < beyond.size(); ++body) {
    if (beyond[static_cast<std::size_t>(robot.bodies()[body].parent)]) beyond[body] = true;
  }
  return beyond;
}

// Counts the configurations in which each pair overlaps.
std::map<BodyPair, int> sample_overlaps(const Robot& robot, OverlapMeter& meter) {
  const std::vector<int> primes = first_primes(robot.joints().size());
  std::map<BodyPair, int> counts;
  std::vector<double> qpos = robot.zero_configuration();
  for (int sample = 1; sample <= kSamples; ++sample) {
    for (std::size_t j = 0; j < robot.joints().size(); ++j) {
      const double turns = sample * std::sqrt(static_cast<double>(primes[j]));
      const auto [lower, upper] = sampled_range(robot, j);
      qpos[robot.joints()[j].qpos_address] = lower + (turns - std::floor(turns)) * (upper - lower);
    }
    for (const auto& [bodies, depth] : meter.measure(qpos)) ++counts[bodies];
  }
  return counts;
}

// Sampled ranges and shapes that differ slightly must not distinguish left and right. Pairs that are
// allowed anyway are left out.
void add_mirror_images(const Robot& robot, const RobotAnatomy& limbs, std::set<BodyPair>& pairs) {
  const std::vector<int> images = mirrored_bodies(robot, limbs);
  std::set<BodyPair> allowed;
  for (const auto& [a, b] : robot.profile().allowed_self_contact) allowed.insert(ordered(a, b));
  for (const auto& [a, b] : std::set<BodyPair>(pairs)) {
    const BodyPair image = ordered(images[a], images[b]);
    if (image.first < 0 || image.first == image.second || allowed.contains(image)) continue;
    pairs.insert(image);
  }
}

}  // namespace

std::vector<ModelOverlap> model_overlaps(const Robot& robot, const RobotAnatomy& limbs,
                                         std::span<const std::vector<double>> poses) {
  OverlapMeter meter(robot);
  std::map<BodyPair, double> depths;
  for (const std::vector<double>& qpos : poses) {
    for (const auto& [bodies, depth] : meter.measure(qpos)) {
      depths[bodies] = std::max(depths[bodies], depth);
    }
  }
  std::map<BodyPair, int> counts = sample_overlaps(robot, meter);
  for (const auto& [bodies, depth] : depths) counts.try_emplace(bodies, 0);
  const std::vector<bool> beyond = beyond_elbows(robot, limbs);
  std::set<BodyPair> found;
  for (const auto& [bodies, count] : counts) {
    const double share = static_cast<double>(count) / kSamples;
    const auto [a, b] = bodies;
    const bool is_hand = beyond[static_cast<std::size_t>(a)] || beyond[static_cast<std::size_t>(b)];
    if (share >= (!depths.contains(bodies) ? kAlways : is_hand ? kOften : 0.0)) {
      found.insert(bodies);
    }
  }
  add_mirror_images(robot, limbs, found);
  std::vector<ModelOverlap> overlaps;
  for (const BodyPair& bodies : found) {
    const auto count = counts.find(bodies);
    const auto in_pose = depths.find(bodies);
    overlaps.push_back(
        {bodies.first, bodies.second, in_pose == depths.end() ? 0.0 : in_pose->second,
         count == counts.end() ? 0.0 : static_cast<double>(count->second) / kSamples});
  }
  return overlaps;
}

std::string overlap_text(const Robot& robot, const ModelOverlap& overlap) {
  const std::string at_rest =
      overlap.depth > 0.0 ? fmt::format("by {:.1f} cm at rest and ", 100.0 * overlap.depth) : "";
  return fmt::format("\"{}\" and \"{}\" overlap {}in {:.0f} % of poses",
                     robot.bodies()[overlap.a].name, robot.bodies()[overlap.b].name, at_rest,
                     100.0 * overlap.share);
}

std::string list_overlaps(const std::vector<std::string>& texts) {
  constexpr std::size_t kMost = 8;
  if (texts.size() <= kMost) return fmt::format("{}", fmt::join(texts, "; "));
  const std::vector<std::string> first(texts.begin(), texts.begin() + kMost);
  return fmt::format("{}; and {} more", fmt::join(first, "; "), texts.size() - kMost);
}

AllowedContacts find_allowed_contacts(const Robot& robot, const RobotAnatomy& limbs,
                                      std::span<const std::pair<std::string, std::string>> excluded,
                                      std::span<const std::vector<double>> poses) {
  AllowedContacts allowed{neighbours(robot), {}};
  for (const auto& [first, second] : excluded) {
    const auto a = robot.find_body(first), b = robot.find_body(second);
    if (a && b) allowed.pairs.emplace_back(*a, *b);
  }
  RobotProfile profile = robot.profile();
  profile.allowed_self_contact = allowed.pairs;
  Robot so_far(ModelPtr(mj_copyModel(nullptr, robot.model())), std::move(profile));
  so_far.set_collision_shapes(robot.collision_shapes());
  allowed.overlaps = model_overlaps(so_far, limbs, poses);
  for (const ModelOverlap& overlap : allowed.overlaps) {
    allowed.pairs.emplace_back(overlap.a, overlap.b);
  }
  return allowed;
}

}  // namespace retarget
