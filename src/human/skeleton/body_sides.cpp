#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "human/skeleton/candidate.h"

namespace retarget {
namespace {

// The knee deviates from the hip-ankle line by much less than the toe from the ankle.
constexpr double kKneeWeight = 3.0;
// Feet shorter than this share of the leg give no direction.
constexpr double kMinFootLength = 0.02;

double leg_says(const BodySource& source, const BodyPoses::Pose& pose, const BoneMap& map,
                Side side, const Eigen::Vector3d& front) {
  const Eigen::Vector3d hip = pose.joints[map.joint(side_bone(side, LimbBone::kUpLeg))];
  const Eigen::Vector3d knee = pose.joints[map.joint(side_bone(side, LimbBone::kLeg))];
  const Eigen::Vector3d ankle = pose.joints[map.joint(side_bone(side, LimbBone::kFoot))];
  const double leg = (knee - hip).norm() + (ankle - knee).norm();
  const int toe = map.joint(side_bone(side, LimbBone::kToe));
  Eigen::Vector3d tip =
      toe >= 0 ? pose.joints[toe] : pose.tips[map.joint(side_bone(side, LimbBone::kFoot))];
  if (toe >= 0 && source.poses.lengths[toe] < kMinFootLength * leg) tip = pose.tips[toe];
  return leg_facing(knee - hip, ankle - knee, tip - ankle, front);
}

// Direction from the hips to the head, or to the arms; zero if there is neither.
Eigen::Vector3d up_of_body(const BodyPoses::Pose& pose, const BoneMap& map) {
  const Eigen::Vector3d hips = pose.joints[map.joint(Bone::kHips)];
  if (map.has(Bone::kHead)) return (pose.joints[map.joint(Bone::kHead)] - hips).normalized();
  if (!map.has(Bone::kLeftArm) || !map.has(Bone::kRightArm)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d arms =
      0.5 * (pose.joints[map.joint(Bone::kLeftArm)] + pose.joints[map.joint(Bone::kRightArm)]);
  return (arms - hips).normalized();
}

}  // namespace

double leg_facing(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
                  const Eigen::Vector3d& foot, const Eigen::Vector3d& front) {
  const double leg = thigh.norm() + shin.norm();
  if (leg <= 0.0) return 0.0;
  // Deviation of the knee from the midpoint between hip and ankle.
  const double knee = kKneeWeight * 0.5 * (thigh - shin).dot(front) / leg;
  return foot.norm() > kMinFootLength * leg ? knee + foot.normalized().dot(front) : knee;
}

double left_is_left(const BodySource& source, const BoneMap& map) {
  for (const Bone bone : {Bone::kHips, Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftLeg,
                          Bone::kRightLeg, Bone::kLeftFoot, Bone::kRightFoot}) {
    if (!map.has(bone)) return 0.0;
  }
  double sum = 0.0;
  for (const BodyPoses::Pose& pose : source.poses.poses) {
    const Eigen::Vector3d across =
        pose.joints[map.joint(Bone::kLeftUpLeg)] - pose.joints[map.joint(Bone::kRightUpLeg)];
    const Eigen::Vector3d front = across.cross(up_of_body(pose, map)).normalized();
    for (const Side side : kSides) sum += leg_says(source, pose, map, side, front);
  }
  return std::clamp(sum / (2.0 * static_cast<double>(source.poses.poses.size())), -1.0, 1.0);
}

namespace {

std::array<std::optional<LegJoints>, 2> find_limbs(const Skeleton& skeleton,
                                                   const Calibration& calibration,
                                                   const std::array<LimbBone, 3>& parts) {
  std::array<std::optional<LegJoints>, 2> limbs;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto joint_of = [&](LimbBone part) {
      const auto& bone = calibration.bones[side_bone(kSides[side], part)];
      // Helper joints at the same position rotate with the joint.
      return is_above(skeleton, bone.position_joint, bone.rotation_joint) ? bone.position_joint
                                                                          : -1;
    };
    const LegJoints limb{joint_of(parts[0]), joint_of(parts[1]), joint_of(parts[2])};
    if (limb.hip >= 0 && limb.knee > limb.hip && limb.ankle > limb.knee &&
        is_above(skeleton, limb.hip, limb.knee) && is_above(skeleton, limb.knee, limb.ankle)) {
      limbs[side] = limb;
    }
  }
  return limbs;
}

}  // namespace

std::array<std::optional<LegJoints>, 2> find_legs(const Skeleton& skeleton,
                                                  const Calibration& calibration) {
  return find_limbs(skeleton, calibration, {LimbBone::kUpLeg, LimbBone::kLeg, LimbBone::kFoot});
}

std::array<std::optional<LegJoints>, 2> find_arms(const Skeleton& skeleton,
                                                  const Calibration& calibration) {
  return find_limbs(skeleton, calibration, {LimbBone::kArm, LimbBone::kForeArm, LimbBone::kHand});
}

namespace {

// Largest difference of left and right lengths, as a share of the longer one.
constexpr double kLengthTolerance = 0.15;
// Differences below this share of the whole body do not matter.
constexpr double kSmallShare = 0.02;
// Limit on the branches of one joint; the longest ones are used.
constexpr std::size_t kMaxWays = 8;

class PairSearch {
 public:
  PairSearch(const BodySource& source, const TreeReach& reach)
      : source_(source), reach_(reach), small_(kSmallShare * reach.diameter()) {}

  // Neighbours of a joint other than `avoid`, those with the longest reach first.
  std::vector<int> ways_out(int joint, int avoid) const {
    std::vector<int> ways;
    for (const int next : source_.tree.neighbours(joint)) {
      if (next != avoid) ways.push_back(next);
    }
    std::ranges::stable_sort(ways, std::greater<>{},
                             [&](int next) { return reach_.reach(joint, next); });
    if (ways.size() > kMaxWays) ways.resize(kMaxWays);
    return ways;
  }

  // Returns the longest equal chains that begin with the steps a to x and b to y. The recursion is
  // as deep as the tree, which the caller bounds.
  ChainPair follow(int a, int x, int b, int y) const {
    const double left = reach_.edge(a, x), right = reach_.edge(b, y);
    if (std::abs(left - right) > std::max(kLengthTolerance * std::max(left, right), small_)) {
      return {};
    }
    ChainPair best;
    for (const int next_x : ways_out(x, a)) {
      for (const int next_y : ways_out(y, b)) {
        ChainPair longer = follow(x, next_x, y, next_y);
        if (longer.reach > best.reach || best.left.size() < longer.left.size()) {
          if (longer.reach >= best.reach) best = std::move(longer);
        }
      }
    }
    best.left.insert(best.left.begin(), x);
    best.right.insert(best.right.begin(), y);
    best.lengths.insert(best.lengths.begin(), 0.5 * (left + right));
    best.reach += 0.5 * (left + right);
    return best;
  }

 private:
  const BodySource& source_;
  const TreeReach& reach_;
  double small_;
};

}  // namespace

TreeReach::TreeReach(const BodySource& source)
    : tree_(source.tree),
      lengths_(source.poses.lengths),
      down_(source.tree.joint_count(), 0.0),
      up_(source.tree.joint_count(), 0.0) {
  const int count = tree_.joint_count();
  for (int joint = 0; joint < count; ++joint) {
    down_[joint] = farthest_end(source.skeleton.joint(joint)).norm();
  }
  for (int joint = count - 1; joint > 0; --joint) {
    double& parent = down_[tree_.parent(joint)];
    parent = std::max(parent, lengths_[joint] + down_[joint]);
  }
  // Longest and second longest path down from a joint, so that one child can be excluded.
  std::vector<double> longest(count, 0.0), second(count, 0.0);
  for (int joint = 1; joint < count; ++joint) {
    const int parent = tree_.parent(joint);
    const double way = lengths_[joint] + down_[joint];
    second[parent] = std::max(second[parent], std::min(longest[parent], way));
    longest[parent] = std::max(longest[parent], way);
  }
  for (int joint = 1; joint < count; ++joint) {
    const int parent = tree_.parent(joint);
    const double way = lengths_[joint] + down_[joint];
    const double others = way == longest[parent] ? second[parent] : longest[parent];
    up_[joint] = lengths_[joint] + std::max(up_[parent], others);
  }
}

double TreeReach::reach(int from, int by) const {
  return tree_.parent(by) == from ? lengths_[by] + down_[by] : up_[from];
}

double TreeReach::diameter() const {
  double longest = 0.0;
  for (std::size_t joint = 0; joint < down_.size(); ++joint) {
    longest = std::max(longest, down_[joint] + up_[joint]);
  }
  return longest;
}

BestPair longest_mirrored_pair(const BodySource& source, const TreeReach& reach, int joint,
                               int avoid) {
  const PairSearch search(source, reach);
  const std::vector<int> ways = search.ways_out(joint, avoid);
  BestPair best;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    for (std::size_t j = i + 1; j < ways.size(); ++j) {
      ChainPair pair = search.follow(joint, ways[i], joint, ways[j]);
      if (pair.reach > best.pair.reach) std::swap(pair, best.pair);
      best.rival_reach = std::max(best.rival_reach, pair.reach);
    }
  }
  return best;
}

}  // namespace retarget
