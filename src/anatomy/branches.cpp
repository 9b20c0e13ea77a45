#include "anatomy/branches.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

namespace retarget {

PosedRobot::PosedRobot(const Robot& robot, const std::vector<double>& qpos)
    : robot_(&robot), world_from_body_(robot.bodies().size()) {
  forward_kinematics(robot, qpos, world_from_body_);
}

Eigen::Vector3d PosedRobot::anchor(int joint) const {
  const RobotJoint& j = robot_->joints()[joint];
  return world_from_body_[j.body] * j.anchor;
}

Eigen::Vector3d PosedRobot::axis(int joint) const {
  const RobotJoint& j = robot_->joints()[joint];
  return world_from_body_[j.body].rotation * j.axis;
}

Eigen::Vector3d PosedRobot::centre_of(const std::vector<int>& joints) const {
  constexpr double kPullToAnchor = 0.01;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const int joint : joints) {
    Eigen::Matrix3d across = (1.0 + kPullToAnchor) * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d along = axis(joint);
    if (robot_->joints()[joint].type == RobotJoint::Type::kHinge) {
      across -= along * along.transpose();
    }
    a += across;
    b += across * anchor(joint);
  }
  return a.inverse() * b;
}

double PosedRobot::spread_about(const Eigen::Vector3d& point,
                                const std::vector<int>& joints) const {
  double sum = 0.0;
  for (const int joint : joints) sum += (point - anchor(joint)).cross(axis(joint)).squaredNorm();
  return joints.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(joints.size()));
}

MovingBodies::MovingBodies(const Robot& robot)
    : robot_(&robot),
      children_(robot.bodies().size()),
      joints_(robot.bodies().size()),
      parts_(robot.bodies().size()),
      carrier_(robot.bodies().size(), 0) {
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    joints_[robot.joints()[j].body].push_back(static_cast<int>(j));
  }
  for (std::size_t b = 1; b < robot.bodies().size(); ++b) {
    const int body = static_cast<int>(b);
    const int parent = carrier_[robot.bodies()[b].parent];
    const bool moves = body == robot.root_body() || !joints_[b].empty();
    carrier_[b] = moves ? body : parent;
    parts_[carrier_[b]].push_back(body);
    if (moves && body != robot.root_body()) children_[parent].push_back(body);
  }
}

int MovingBodies::joint_count_below(int body) const {
  int count = static_cast<int>(joints_[body].size());
  for (const int child : children_[body]) count += joint_count_below(child);
  return count;
}

std::vector<int> MovingBodies::chain(int first) const {
  constexpr std::size_t kWholeLimb = 4;
  std::vector<int> chain;
  for (int body = first;;) {
    for (const int joint : joints_[body]) {
      if (robot_->joints()[joint].type == RobotJoint::Type::kSlide) return chain;
      chain.push_back(joint);
    }
    const std::vector<int>& next = children_[body];
    if (next.empty() || (next.size() > 1 && chain.size() >= kWholeLimb)) return chain;
    body = *std::ranges::max_element(next, {}, [&](int child) { return joint_count_below(child); });
  }
}

namespace {

// how far two chains are from mirror images about a plane across an axis, in their own size; none
// when they are not on two sides
std::optional<double> asymmetry(const PosedRobot& posed, const std::vector<int>& first,
                                const std::vector<int>& second, const Eigen::Vector3d& across) {
  double size = 0.0;
  double worst = 0.0;
  double apart = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Eigen::Vector3d gap = posed.anchor(first[i]) - posed.anchor(second[i]);
    const double along = gap.dot(across);
    // an anchor may stand anywhere on its axis
    const Eigen::Vector3d axis = posed.axis(first[i]);
    const Eigen::Vector3d aside = gap - along * across;
    worst = std::max(worst, (aside - aside.dot(axis) * axis).norm());
    apart += along / static_cast<double>(first.size());
    size = std::max(size, (posed.anchor(first[i]) - posed.anchor(first[0])).norm());
  }
  if (!(apart > 0.02 * size) || !(size > 0.0)) return std::nullopt;
  return worst / size;
}

double lowest_joint(const PosedRobot& posed, const std::vector<int>& chain) {
  double lowest = posed.anchor(chain.front()).z();
  for (const int joint : chain) lowest = std::min(lowest, posed.anchor(joint).z());
  return lowest;
}

std::optional<BranchPair> pair_of(const PosedRobot& posed, const MovingBodies& moving, int first,
                                  int second) {
  constexpr double kMirrored = 0.25;
  const std::vector<int> a = moving.chain(first);
  const std::vector<int> b = moving.chain(second);
  if (a.size() != b.size() || a.size() < 2) return std::nullopt;
  std::optional<BranchPair> best;
  double least = kMirrored;
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0)}) {
    for (const double sign : {1.0, -1.0}) {
      const auto found = asymmetry(posed, a, b, sign * axis);
      if (!found || !(*found < least)) continue;
      least = *found;
      best = BranchPair{0,
                        first,
                        second,
                        axis,
                        std::min(lowest_joint(posed, a), lowest_joint(posed, b)),
                        static_cast<int>(a.size())};
      if (sign < 0.0) std::swap(best->first, best->second);
    }
  }
  return best;
}

void collect_pairs(const PosedRobot& posed, const MovingBodies& moving, int trunk,
                   std::vector<BranchPair>& pairs) {
  std::vector<int> rest = moving.children(trunk);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    for (std::size_t k = i + 1; k < rest.size(); ++k) {
      auto pair = pair_of(posed, moving, rest[i], rest[k]);
      if (!pair) continue;
      pair->parent = trunk;
      pairs.push_back(*pair);
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      --i;
      break;
    }
  }
  for (const int child : rest) collect_pairs(posed, moving, child, pairs);
}

}  // namespace

std::vector<BranchPair> branch_pairs(const PosedRobot& posed, const MovingBodies& moving) {
  std::vector<BranchPair> pairs;
  collect_pairs(posed, moving, posed.robot().root_body(), pairs);
  return pairs;
}

}  // namespace retarget
