#pragma once

#include <Eigen/Core>
#include <string>

namespace retarget {

/// A box as an OBJ file: from lower to upper corner, each face as two triangles.
inline std::string box_obj(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  std::string text;
  for (const double x : {lower.x(), upper.x()}) {
    for (const double y : {lower.y(), upper.y()}) {
      for (const double z : {lower.z(), upper.z()}) {
        text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
      }
    }
  }
  for (const char* face : {"1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"}) {
    text += std::string("f ") + face + "\n";
  }
  return text;
}

}  // namespace retarget
