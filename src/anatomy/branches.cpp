#include "anatomy/branches.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace retarget {

std::vector<int> joint_chain(const KinematicTree& tree, int first) {
  constexpr std::size_t kWholeLimb = 4;
  std::vector<int> chain;
  for (int link = first;;) {
    if (tree.links()[link].slides) return chain;
    chain.push_back(tree.links()[link].joint);
    const std::vector<int> next = tree.children(link);
    if (next.empty() || (next.size() > 1 && chain.size() >= kWholeLimb)) return chain;
    link = *std::ranges::max_element(
        next, {}, [&](int child) { return tree.links()[child].last_descendant - child; });
  }
}

namespace {

// how far two chains are from mirror images about a plane across an axis, in their own size; none
// when they are not on two sides
std::optional<double> asymmetry(const TreeState& posed, const std::vector<int>& first,
                                const std::vector<int>& second, const Eigen::Vector3d& across) {
  double size = 0.0;
  double worst = 0.0;
  double apart = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Eigen::Vector3d gap = posed.anchor(first[i]) - posed.anchor(second[i]);
    const double along = gap.dot(across);
    // an anchor may stand anywhere on its axis
    const Eigen::Vector3d& axis = posed.axis(first[i]);
    const Eigen::Vector3d aside = gap - along * across;
    worst = std::max(worst, (aside - aside.dot(axis) * axis).norm());
    apart += along / static_cast<double>(first.size());
    size = std::max(size, (posed.anchor(first[i]) - posed.anchor(first[0])).norm());
  }
  if (!(apart > 0.02 * size) || !(size > 0.0)) return std::nullopt;
  return worst / size;
}

// of all joints of a branch, also those beyond where its chain ends
double lowest_joint(const TreeState& posed, int first) {
  const auto& links = posed.tree->links();
  double lowest = posed.anchor(links[first].joint).z();
  for (int link = first; link <= links[first].last_descendant; ++link) {
    lowest = std::min(lowest, posed.anchor(links[link].joint).z());
  }
  return lowest;
}

std::optional<BranchPair> pair_of(const TreeState& posed, int first, int second) {
  constexpr double kMirrored = 0.25;
  const std::vector<int> a = joint_chain(*posed.tree, first);
  const std::vector<int> b = joint_chain(*posed.tree, second);
  if (a.size() != b.size() || a.size() < 2) return std::nullopt;
  std::optional<BranchPair> best;
  double min = kMirrored;
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0)}) {
    for (const double sign : {1.0, -1.0}) {
      const auto found = asymmetry(posed, a, b, sign * axis);
      if (!found || !(*found < min)) continue;
      min = *found;
      best = BranchPair{0,
                        first,
                        second,
                        axis,
                        std::min(lowest_joint(posed, first), lowest_joint(posed, second)),
                        static_cast<int>(a.size())};
      if (sign < 0.0) std::swap(best->first, best->second);
    }
  }
  return best;
}

void collect_pairs(const TreeState& posed, int trunk, std::vector<BranchPair>& pairs) {
  std::vector<int> rest = posed.tree->children(trunk);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t k = i + 1; k < rest.size(); ++k) {
      auto pair = pair_of(posed, rest[i], rest[k]);
      if (!pair) continue;
      pair->parent = trunk;
      pairs.push_back(*pair);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      --i;
      break;
    }
  }
  for (const int child : rest) collect_pairs(posed, child, pairs);
}

}  // namespace

std::vector<BranchPair> branch_pairs(const TreeState& posed) {
  std::vector<BranchPair> pairs;
  collect_pairs(posed, 0, pairs);
  return pairs;
}

}  // namespace retarget
