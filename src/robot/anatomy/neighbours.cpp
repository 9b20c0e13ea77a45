#include "robot/anatomy/neighbours.h"

#include "robot/model/kinematic_tree.h"

namespace retarget {
namespace {

// Bodies at most this many joints apart in the tree may touch.
constexpr int kNeighbours = 2;

}  // namespace

std::vector<std::pair<int, int>> neighbours(const Robot& robot) {
  const KinematicTree& tree = robot.tree();
  std::vector<std::pair<int, int>> pairs;
  for (int body = 1; body < static_cast<int>(robot.bodies().size()); ++body) {
    if (tree.carrier(body) != body) continue;
    int above = body;
    for (int i = 0; i < kNeighbours && above != robot.root_body(); ++i) {
      above = tree.carrier(robot.bodies()[above].parent);
      pairs.emplace_back(above, body);
    }
  }
  return pairs;
}

}  // namespace retarget
