#pragma once

#include <algorithm>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Bodies from the child of the world down to this one.
inline std::vector<int> path_to(const Robot& robot, int body) {
  std::vector<int> path;
  for (int at = body; at > 0; at = robot.bodies()[static_cast<std::size_t>(at)].parent) {
    path.push_back(at);
  }
  std::ranges::reverse(path);
  return path;
}

}  // namespace retarget
