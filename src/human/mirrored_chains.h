#pragma once

#include <vector>

#include "human/candidate.h"
#include "human/skeleton_tree.h"

namespace retarget {

/// Two chains of joints that leave a body on either side and have equal lengths.
struct ChainPair {
  std::vector<int> left, right;  ///< From the body outwards, of equal size; sides as they come.
  std::vector<double> lengths;   ///< Per joint the mean distance from the one before it.
  double reach = 0.0;            ///< Sum of lengths.
};

/// Distances along the tree and the longest way out of a joint by each of its neighbours.
class TreeReach {
 public:
  explicit TreeReach(const BodySource& source);

  /// Distance between neighbours.
  [[nodiscard]] double edge(int a, int b) const { return lengths_[tree_.parent(a) == b ? a : b]; }
  /// The longest path that leaves `from` by its neighbour `by`; end sites count.
  [[nodiscard]] double reach(int from, int by) const;
  /// The longest path of the whole tree.
  [[nodiscard]] double diameter() const;

 private:
  const SkeletonTree& tree_;
  const std::vector<double>& lengths_;
  std::vector<double> down_;  // from a joint to the farthest below it
  std::vector<double> up_;    // from a joint to the farthest not below it
};

/// The longest pair of equal chains among the ways out of a joint, not by `avoid` (a neighbour).
/// Pairs of nearly that length that have another joint at their beginning are counted as rivals.
struct BestPair {
  ChainPair pair;
  double rival_reach = 0.0;  ///< Of the longest other pair; 0: none.
};
[[nodiscard]] BestPair longest_mirrored_pair(const BodySource& source, const TreeReach& reach,
                                             int joint, int avoid);

}  // namespace retarget
