#pragma once

#include <vector>

#include "human/skeleton/candidate.h"
#include "human/skeleton/skeleton_tree.h"

namespace retarget {

/// Two chains of joints of equal lengths that leave a body on either side.
struct ChainPair {
  std::vector<int> left, right;  ///< From the body outwards, of equal size; which is left is
                                 ///< undecided.
  std::vector<double> lengths;   ///< Mean distance of a joint from the previous one.
  double reach = 0.0;            ///< Sum of `lengths`.
};

/// Distances along the tree and longest paths from a joint through each neighbour.
class TreeReach {
 public:
  explicit TreeReach(const BodySource& source);

  /// Returns the distance between neighbours.
  [[nodiscard]] double edge(int a, int b) const { return lengths_[tree_.parent(a) == b ? a : b]; }
  /// Returns the length of the longest path from `from` through its neighbour `by`; end sites
  /// count.
  [[nodiscard]] double reach(int from, int by) const;
  /// Returns the length of the longest path of the tree.
  [[nodiscard]] double diameter() const;

 private:
  const SkeletonTree& tree_;
  const std::vector<double>& lengths_;
  std::vector<double> down_;  // From a joint to the farthest one below it.
  std::vector<double> up_;    // From a joint to the farthest one not below it.
};

/// The longest pair of equal chains that leave a joint, not through its neighbour `avoid`. Pairs of
/// similar length that begin with another joint count as rivals.
struct BestPair {
  ChainPair pair;
  double rival_reach = 0.0;  ///< Reach of the longest other pair; 0: none.
};
[[nodiscard]] BestPair longest_mirrored_pair(const BodySource& source, const TreeReach& reach,
                                             int joint, int avoid);

}  // namespace retarget
