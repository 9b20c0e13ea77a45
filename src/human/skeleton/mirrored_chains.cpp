#include "human/skeleton/mirrored_chains.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace retarget {
namespace {

// Largest difference of left and right lengths, as a share of the longer one.
constexpr double kLengthTolerance = 0.15;
// Differences below this share of the whole body do not matter.
constexpr double kSmallShare = 0.02;
// Limit on the branches of one joint; the longest ones count.
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
