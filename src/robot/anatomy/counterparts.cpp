#include "robot/anatomy/counterparts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

constexpr std::size_t kLimb = 3;  // Joints of a limb at least.

class CounterpartSearch {
 public:
  CounterpartSearch(const Robot& robot, const TreeState& posed,
                    const std::vector<BranchPair>& pairs)
      : robot_(robot), tree_(robot.tree()), posed_(posed), pairs_(pairs) {}

  // Looks at the branches of a trunk link, then beyond those that carry pairs.
  [[nodiscard]] std::optional<std::string> below(int trunk) const;

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
  [[nodiscard]] std::optional<std::string> differing(int first, int second) const;
  [[nodiscard]] std::optional<std::string> alone(int link) const;

  const Robot& robot_;
  const KinematicTree& tree_;
  const TreeState& posed_;
  const std::vector<BranchPair>& pairs_;
};

// Two branches whose joints mirror each other until one of them is missing.
std::optional<std::string> CounterpartSearch::differing(int first, int second) const {
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
  return fmt::format("the limbs starting at {} and {} have {} and {} joints: {} has no counterpart",
                     name_of(longer[0]), name_of(shorter[0]), longer.size(), shorter.size(),
                     name_of(missing.front()));
}

// A branch beside the trunk.
std::optional<std::string> CounterpartSearch::alone(int link) const {
  constexpr double kBeside = 0.1;  // Fraction of the distance between the limbs of a pair.
  const std::vector<int> chain = joint_chain(robot_, link);
  if (pairs_.empty() || chain.size() < kLimb || carries_pair(link)) return std::nullopt;
  const BranchPair& pair = pairs_.front();
  const auto place = [&](int first) { return posed_.anchor(tree_.links()[first].joint); };
  const Eigen::Vector3d middle = 0.5 * (place(pair.first) + place(pair.second));
  const double width = (place(pair.first) - place(pair.second)).dot(pair.across);
  const double aside = (place(link) - middle).dot(pair.across);
  if (std::abs(aside) < kBeside * std::abs(width)) return std::nullopt;
  return fmt::format("the limb starting at {} has no counterpart on the other side",
                     name_of(chain[0]));
}

std::optional<std::string> CounterpartSearch::below(int trunk) const {
  std::vector<int> rest;
  for (const int child : tree_.children(trunk)) {
    if (!is_paired(child)) rest.push_back(child);
  }
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t k = i + 1; k < rest.size(); ++k) {
      if (auto found = differing(rest[i], rest[k])) return found;
    }
  }
  for (const int child : rest) {
    if (auto found = alone(child)) return found;
    if (auto found = below(child)) return found;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> missing_counterpart(const Robot& robot, const TreeState& posed,
                                               const std::vector<BranchPair>& pairs) {
  return CounterpartSearch(robot, posed, pairs).below(0);
}

}  // namespace retarget
