#include "solve/dynamics/body_size.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "robot/model/kinematic_tree.h"

namespace retarget {
namespace {

constexpr double kLegOfG1 = 0.632;  // Metres.

// Joints from the base to a link.
std::vector<int> joints_to(const KinematicTree& tree, int link) {
  std::vector<int> joints;
  for (; link > 0; link = tree.links()[static_cast<std::size_t>(link)].parent) {
    joints.insert(joints.begin(), tree.links()[static_cast<std::size_t>(link)].joint);
  }
  return joints;
}

// Leg length (hip to knee to ankle), metres; 0 if the joints are not a leg. The shank is the last
// long segment between consecutive joints; the knee is the joint at its upper end.
double leg_length(const TreeState& state, const std::vector<int>& joints) {
  constexpr double kLong = 0.6;  // Share of the longest segment.
  const auto way = [&](std::size_t i) {
    return (state.anchor(joints[i + 1]) - state.anchor(joints[i])).norm();
  };
  double longest = 0.0;
  for (std::size_t i = 0; i + 1 < joints.size(); ++i) longest = std::max(longest, way(i));
  std::size_t knee = 0;
  for (std::size_t i = 1; i + 1 < joints.size(); ++i) {
    if (way(i) >= kLong * longest) knee = i;
  }
  if (knee == 0) return 0.0;
  const std::span all(joints);
  const Eigen::Vector3d hip = common_point(state, all.first(knee));
  const Eigen::Vector3d ankle = common_point(state, all.subspan(knee + 1));
  const Eigen::Vector3d& middle = state.anchor(joints[knee]);
  return (middle - hip).norm() + (ankle - middle).norm();
}

}  // namespace

double body_size(const Robot& robot) {
  const KinematicTree& tree = robot.tree();
  const TreeState state(tree, robot.zero_configuration());
  double longest = 0.0;
  for (const Sole& sole : robot.profile().soles) {
    const int link = tree.attachment(sole.body).link;
    longest = std::max(longest, leg_length(state, joints_to(tree, link)));
  }
  return longest > 0.0 ? std::round(100.0 * longest / kLegOfG1) / 100.0 : 1.0;
}

}  // namespace retarget
