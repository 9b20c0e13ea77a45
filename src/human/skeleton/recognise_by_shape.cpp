#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "human/skeleton/candidate.h"
#include "human/skeleton/posed_body.h"
#include "retarget/human.h"

namespace retarget {
namespace {

using enum LimbBone;

// First term of the series in (x - 1) / (x + 1). Unlike std::log, it is identical on every machine.
double log_of_near_one(double x) {
  return 2.0 * (x - 1.0) / (x + 1.0);
}

// exp(-x^2 / 2), as the reciprocal of the first terms of exp(x^2 / 2).
double bell(double x) {
  const double y = 0.5 * x * x;
  return 1.0 / (1.0 + y * (1.0 + y / 2.0 * (1.0 + y / 3.0 * (1.0 + y / 4.0))));
}

// No human skeleton is larger. Bounds time and recursion depth.
constexpr int kMaxJoints = 1000;
// Hips and torso have three branches longer than this share of the tree's diameter.
constexpr double kMinReach = 0.12;
constexpr std::size_t kMaxHubs = 16;
constexpr double kShapeConfidence = 0.7;
// Joints closer than this share of a chain coincide.
constexpr double kSamePlace = 0.02;

// The three joints of a chain that form a limb.
struct TracedLimb {
  std::size_t upper = 0, lower = 0, end = 0;
  double merit = 0.0;
};

// A joint that may carry a pair of limbs.
struct Hub {
  int joint = -1;
  double reach = 0.0;
};

// Two hubs and their pairs of chains.
struct Shape {
  int hips = -1, torso = -1;
  ChainPair legs, arms;
  double reach = 0.0;
  // Reach of the longest other pair at the hips and at the torso; 0: none.
  double rival_of_legs = 0.0, rival_of_arms = 0.0;
};

std::vector<Hub> find_hubs(const BodySource& source, const TreeReach& reach) {
  std::vector<Hub> hubs;
  const double min = kMinReach * reach.diameter();
  for (int joint = 0; joint < source.tree.joint_count(); ++joint) {
    std::vector<double> ways;
    for (const int next : source.tree.neighbours(joint)) ways.push_back(reach.reach(joint, next));
    if (ways.size() < 3) continue;
    std::ranges::sort(ways, std::greater<>{});
    if (ways[2] >= min) hubs.push_back({joint, ways[2]});
  }
  std::ranges::stable_sort(hubs, std::greater<>{}, &Hub::reach);
  if (hubs.size() > kMaxHubs) hubs.resize(kMaxHubs);
  return hubs;
}

// End of a limb within a chain: the number of its joints.
struct TracedEnd {
  std::size_t size = 0;
  bool spreads = false;  // The last joint carries fingers or several toes.
};

// A limb ends where fingers spread, else before much shorter segments.
TracedEnd end_of_limb(const BodySource& source, const TreeReach& reach, const ChainPair& pair) {
  constexpr double kSpread = 0.5, kShortSegment = 0.6;
  for (std::size_t i = 1; i + 1 < pair.left.size(); ++i) {
    std::vector<double> ways;
    for (const int next : source.tree.neighbours(pair.left[i])) {
      if (next != pair.left[i - 1]) ways.push_back(reach.reach(pair.left[i], next));
    }
    std::ranges::sort(ways, std::greater<>{});
    if (ways.size() > 1 && ways[0] > 0.0 && ways[1] > kSpread * ways[0]) return {i + 1, true};
  }
  std::size_t size = pair.left.size();
  const double longest = *std::max_element(pair.lengths.begin() + 1, pair.lengths.end());
  while (size > 3 && pair.lengths[size - 1] < kShortSegment * longest) --size;
  return {size, false};
}

// Proportions of a kind of limb.
struct LimbShape {
  double lower_per_upper;  // Shin per thigh, forearm per upper arm.
  // Maximum length of a helper or clavicle, as a share of the distance from it to the limb's second
  // joint.
  double max_before;
  // Whether the joint at which the chain spreads ends the limb: true for hands; toes may spread
  // from the foot or the toe joint.
  bool ends_in_spread;
};
constexpr LimbShape kLegShape = {1.0, 0.2, false};
constexpr LimbShape kArmShape = {0.85, 0.46, true};

// The three joints of a chain that resemble a limb most.
TracedLimb find_limb(const BodySource& source, const TreeReach& reach, const ChainPair& pair,
                     const LimbShape& shape) {
  const auto [size, spreads] = end_of_limb(source, reach, pair);
  constexpr double kRatioSpread = 0.2;
  std::vector<double> along(size, 0.0);
  for (std::size_t i = 1; i < size; ++i) along[i] = along[i - 1] + pair.lengths[i];
  // Left and right limbs do not begin at the same position.
  std::size_t first = 0;
  const double min = kSamePlace * pair.reach;
  while (first < size && pair.lengths[0] + along[first] < min) ++first;
  TracedLimb best;
  for (std::size_t i = first; i < size; ++i) {
    for (std::size_t j = i + 1; j < size; ++j) {
      for (std::size_t k = j + 1; k < size; ++k) {
        const double upper = along[j] - along[i], lower = along[k] - along[j];
        if (upper <= 0.0 || lower <= 0.0) continue;
        if (spreads && shape.ends_in_spread && k + 1 < size) continue;
        const double deviation =
            log_of_near_one(lower / upper / shape.lower_per_upper) / kRatioSpread;
        const double merit = upper * lower * bell(deviation);
        if (merit > best.merit) best = {i, j, k, merit};
      }
    }
  }
  // Helpers and clavicles precede the joint that turns the limb.
  while (best.merit > 0.0 && best.upper + 1 < best.lower &&
         along[best.upper + 1] - along[best.upper] <
             shape.max_before * (along[best.lower] - along[best.upper])) {
    ++best.upper;
  }
  return best;
}

// Next joint before or after a limb at a different position; -1 if there is none.
int neighbour_at(const ChainPair& pair, const std::vector<int>& side, std::size_t from, int step) {
  const double min = kSamePlace * pair.reach;
  for (auto i = static_cast<long>(from) + step; i >= 0 && i < static_cast<long>(side.size());
       i += step) {
    const double length = pair.lengths[static_cast<std::size_t>(step > 0 ? i : i + 1)];
    if (length > min) return side[static_cast<std::size_t>(i)];
  }
  return -1;
}

// Sum over the poses of a joint's height above the torso, along the body's own up direction.
double height_above_torso(const BodySource& source, const Shape& shape, int joint) {
  double height = 0.0;
  for (const BodyPoses::Pose& pose : source.poses.poses) {
    const Eigen::Vector3d torso = pose.joints[shape.torso];
    height += (pose.joints[joint] - torso).dot((torso - pose.joints[shape.hips]).normalized());
  }
  return height;
}

// Whether the last joint of torso, neck and head is only the top of the head: it carries nothing,
// or it is farther from the head than the head from the neck.
bool ends_in_top(const BodySource& source, const std::vector<int>& chain) {
  constexpr double kLongerThanNeck = 1.25;
  if (chain.size() < 3) return false;
  const int last = chain.back(), before = chain[chain.size() - 2];
  if (source.tree.neighbours(last).size() != 1) return false;
  const auto& ends = source.skeleton.joint(last).end_sites;
  if (std::ranges::all_of(ends, [](const Eigen::Vector3d& end) { return end.norm() < 1e-9; })) {
    return true;
  }
  const std::vector<double>& lengths = source.poses.lengths;
  return lengths[before] > 0.0 && lengths[last] > kLongerThanNeck * lengths[before];
}

// Chain to the head: of the other branches of torso and spine, the one that reaches highest.
std::vector<int> find_head_chain(const BodySource& source, const Shape& shape) {
  const std::vector<int> trunk = source.tree.path(shape.torso, shape.hips);
  std::vector<int> best;
  double best_height = 0.0;
  for (std::size_t i = 0; i + 1 < trunk.size(); ++i) {
    for (const int way : source.tree.neighbours(trunk[i])) {
      const bool is_arm = way == shape.arms.left[0] || way == shape.arms.right[0];
      if (is_arm || std::ranges::find(trunk, way) != trunk.end()) continue;
      // The chain ends at the head, which carries eyes and jaw, or nothing.
      std::vector<int> chain = source.tree.chain(trunk[i], way);
      const double height = height_above_torso(source, shape, chain.back());
      if (height <= best_height) continue;
      best = std::move(chain);
      best_height = height;
    }
  }
  if (ends_in_top(source, best)) best.pop_back();
  return best;
}

// Positive if the pairs are legs and arms in this order.
double order_merit(const BodySource& source, const TreeReach& reach, const Shape& shape) {
  double merit = 0.0;
  // A third branch, in addition to the link between hips and torso, is neck and head, or a tail.
  merit += source.tree.neighbours(shape.torso).size() > 3 ? 1.0 : 0.0;
  merit -= source.tree.neighbours(shape.hips).size() > 3 ? 0.5 : 0.0;
  // Legs are longer than arms, and thigh and shin are closer to equal length.
  const TracedLimb leg = find_limb(source, reach, shape.legs, kLegShape);
  const TracedLimb arm = find_limb(source, reach, shape.arms, kArmShape);
  merit += leg.merit > arm.merit ? 0.6 : -0.6;
  // Clavicles precede the arm, and fingers spread from the hand.
  merit += arm.upper > leg.upper ? 0.4 : arm.upper < leg.upper ? -0.4 : 0.0;
  merit += source.tree.depth(shape.hips) < source.tree.depth(shape.torso) ? 0.3 : -0.3;
  return merit;
}

constexpr double kEqualReach = 0.02;

// Finds the two hubs with the longest chains.
Result<std::optional<Shape>> find_shape(const BodySource& source, const TreeReach& reach) {
  const std::vector<Hub> hubs = find_hubs(source, reach);
  std::optional<Shape> best;
  bool rivalled = false;
  for (std::size_t i = 0; i < hubs.size(); ++i) {
    for (std::size_t j = i + 1; j < hubs.size(); ++j) {
      const std::vector<int> link = source.tree.path(hubs[i].joint, hubs[j].joint);
      const BestPair a = longest_mirrored_pair(source, reach, hubs[i].joint, link[1]);
      const BestPair b = longest_mirrored_pair(source, reach, hubs[j].joint, link[link.size() - 2]);
      if (a.pair.left.size() < 3 || b.pair.left.size() < 3) continue;
      const double sum = a.pair.reach + b.pair.reach;
      const double rival =
          std::max(sum - a.pair.reach + a.rival_reach, sum - b.pair.reach + b.rival_reach);
      if (best && sum <= best->reach) {
        rivalled = rivalled || sum > (1.0 - kEqualReach) * best->reach;
        continue;
      }
      rivalled =
          (best && best->reach > (1.0 - kEqualReach) * sum) || rival > (1.0 - kEqualReach) * sum;
      best = Shape{hubs[i].joint, hubs[j].joint, a.pair, b.pair, sum, a.rival_reach, b.rival_reach};
    }
  }
  if (best && rivalled) {
    return input_failure({},
                         "the skeleton has several pairs of equal limbs, and its joint names do "
                         "not distinguish arms and legs",
                         "give a bone map with " OPTION("map"));
  }
  if (best) {
    Shape swapped = *best;
    std::swap(swapped.hips, swapped.torso);
    std::swap(swapped.legs, swapped.arms);
    std::swap(swapped.rival_of_legs, swapped.rival_of_arms);
    if (order_merit(source, reach, swapped) > order_merit(source, reach, *best)) best = swapped;
  }
  return best;
}

// Maps the limbs of both pairs. Returns false if a pair contains no limb.
bool map_limbs(const BodySource& source, const TreeReach& reach, const Shape& shape, BoneMap& map) {
  const TracedLimb leg = find_limb(source, reach, shape.legs, kLegShape);
  const TracedLimb arm = find_limb(source, reach, shape.arms, kArmShape);
  if (leg.merit <= 0.0 || arm.merit <= 0.0) return false;
  for (const Side side : kSides) {
    const bool left = side == Side::kLeft;
    const auto set = [&](LimbBone part, int joint) {
      map.joint_of_bone[side_bone(side, part)] = joint;
    };
    const std::vector<int>& legs = left ? shape.legs.left : shape.legs.right;
    set(kUpLeg, legs[leg.upper]);
    set(kLeg, legs[leg.lower]);
    set(kFoot, legs[leg.end]);
    set(kToe, neighbour_at(shape.legs, legs, leg.end, 1));
    const std::vector<int>& arms = left ? shape.arms.left : shape.arms.right;
    set(kShoulder, neighbour_at(shape.arms, arms, arm.upper, -1));
    set(kArm, arms[arm.upper]);
    set(kForeArm, arms[arm.lower]);
    set(kHand, arms[arm.end]);
  }
  return true;
}

void swap_sides(BoneMap& map, std::initializer_list<LimbBone> parts) {
  for (const LimbBone part : parts) {
    std::swap(map.joint_of_bone[side_bone(Side::kLeft, part)],
              map.joint_of_bone[side_bone(Side::kRight, part)]);
  }
}

// Agreement of the sides of arms and legs: negative if they are crossed.
double arms_agree(const BodySource& source, const BoneMap& map) {
  double sum = 0.0;
  for (const BodyPoses::Pose& pose : source.poses.poses) {
    const auto across = [&](Bone left, Bone right) -> Eigen::Vector3d {
      return (pose.joints[map.joint(left)] - pose.joints[map.joint(right)]).normalized();
    };
    sum += across(Bone::kLeftUpLeg, Bone::kRightUpLeg).dot(across(Bone::kLeftArm, Bone::kRightArm));
  }
  return sum / static_cast<double>(source.poses.poses.size());
}

constexpr double kMinEvidence = 0.1;

Result<void> find_sides(const BodySource& source, BoneMap& map) {
  const double agree = arms_agree(source, map);
  if (agree < 0.0) swap_sides(map, {kShoulder, kArm, kForeArm, kHand});
  const double left = left_is_left(source, map);
  if (left < 0.0) {
    swap_sides(map, {kUpLeg, kLeg, kFoot, kToe, kShoulder, kArm, kForeArm, kHand});
  }
  if (std::abs(left) >= kMinEvidence && std::abs(agree) >= kMinEvidence) return {};
  return input_failure(
      {},
      "neither the joint names nor the poses distinguish the left and the right side of the body",
      "give a bone map with " OPTION("map"));
}

// Notes pairs of chains, such as wings, that may be the limbs instead of the longest pairs.
void note_rivals(const Shape& shape, BoneMap& map) {
  constexpr double kLikeALimb = 0.35, kDoubtful = 0.6;
  const auto note = [&](double rival, const ChainPair& limbs, const char* part, const char* name) {
    if (rival < kLikeALimb * limbs.reach) return;
    map.confidence *= kDoubtful;
    map.notes.push_back(fmt::format(
        "two pairs of limbs hang from the {}, and the longer one is assumed to be the {}; if the "
        "other one is right, give a bone map with " OPTION("map"),
        part, name));
  };
  note(shape.rival_of_legs, shape.legs, "hips", "legs");
  note(shape.rival_of_arms, shape.arms, "torso", "arms");
}

}  // namespace

Candidate recognise_by_shape(const BodySource& source) {
  if (source.tree.joint_count() > kMaxJoints) return std::nullopt;
  const TreeReach reach(source);
  TRY_ASSIGN(const std::optional<Shape> shape, find_shape(source, reach));
  if (!shape) return std::nullopt;
  BoneMap map;
  map.profile = "topology";
  if (!map_limbs(source, reach, *shape, map)) return std::nullopt;
  const std::vector<int> head = find_head_chain(source, *shape);
  if (!head.empty()) map.joint_of_bone[Bone::kHead] = head.back();
  complete_trunk(source, map);
  if (!map.has(Bone::kHips) || !map.has(Bone::kSpine2)) return std::nullopt;
  TRY(find_sides(source, map));
  map.confidence = kShapeConfidence;
  map.notes.emplace_back(
      "recognised by the shape of the joint tree: the joint names are not reliable");
  note_rivals(*shape, map);
  return map;
}

}  // namespace retarget
