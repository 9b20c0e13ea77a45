#include "anatomy/neighbours.h"

#include <algorithm>

namespace retarget {
namespace {

// bodies that joints at most this far apart in the tree carry may touch
constexpr int kNeighbours = 2;

// the moving body that carries each body
std::vector<int> carriers(const Robot& robot) {
  std::vector<int> carrier(robot.bodies().size(), 0);
  for (std::size_t b = 1; b < carrier.size(); ++b) {
    const int body = static_cast<int>(b);
    const bool moves = std::ranges::any_of(
        robot.joints(), [&](const RobotJoint& joint) { return joint.body == body; });
    carrier[b] = moves || body == robot.root_body()
                     ? body
                     : carrier[static_cast<std::size_t>(robot.bodies()[b].parent)];
  }
  return carrier;
}

}  // namespace

std::vector<std::pair<int, int>> neighbours(const Robot& robot) {
  const std::vector<int> carrier = carriers(robot);
  const auto up = [&](int body) {
    const int parent = robot.bodies()[static_cast<std::size_t>(body)].parent;
    return carrier[static_cast<std::size_t>(parent)];
  };
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t b = 1; b < carrier.size(); ++b) {
    const int body = static_cast<int>(b);
    if (carrier[b] != body) continue;
    int above = body;
    for (int i = 0; i < kNeighbours && above != robot.root_body(); ++i) {
      above = up(above);
      if (above <= 0) break;
      pairs.emplace_back(above, body);
    }
  }
  return pairs;
}

}  // namespace retarget
