// A program of another project: calls into the library, its Eigen types and its MuJoCo.

#include <iostream>
#include <string>
#include <vector>

#include "retarget/base/suggest.h"
#include "retarget/motion/frame_rate.h"
#include "retarget/version.h"

int main() {
  const std::vector<std::string> robots = {"unitree_g1", "unitree_h1"};
  if (retarget::nearest_name("unitree_G1", robots) != "unitree_g1") return 1;
  std::cout << retarget::version_text() << "\n";
  return 0;
}
