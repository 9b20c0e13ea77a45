// A program of another project: calls into the library, its Eigen types, its MuJoCo and its zlib.

#include <iostream>
#include <string>
#include <vector>

#include "retarget/base/npz.h"
#include "retarget/base/suggest.h"
#include "retarget/motion/frame_rate.h"
#include "retarget/version.h"

int main() {
  const std::vector<std::string> robots = {"unitree_g1", "unitree_h1"};
  if (retarget::nearest_name("unitree_G1", robots) != "unitree_g1") return 1;
  // a file without arrays
  const std::string empty = std::string("PK\x05\x06") + std::string(18, '\0');
  const auto file = retarget::NpzFile::open(empty, "empty.npz");
  if (!file || file->read("poses")) return 1;
  std::cout << retarget::version_text() << "\n";
  return 0;
}
