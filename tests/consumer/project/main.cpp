// A program of another project: calls into the library, its Eigen types, its MuJoCo and its zlib.

#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/npz.h"
#include "base/suggest.h"
#include "motion/forward_kinematics.h"
#include "retarget/clip.h"
#include "retarget/pose.h"
#include "retarget/version.h"

namespace {

static_assert(alignof(retarget::Pose) == 16, "as in the library, whatever -march is here");

// quaternions that the library stores and this program writes, and the other way round: both must
// lay them out alike, whatever instructions each was compiled for
bool poses_pass_between() {
  std::vector<retarget::Joint> joints(3);
  for (int i = 0; i < 3; ++i) {
    joints[i].name = "joint" + std::to_string(i);
    joints[i].parent = i - 1;
    joints[i].offset = Eigen::Vector3d(0.0, i == 0 ? 0.0 : 1.0, 0.0);
  }
  const auto skeleton = std::make_shared<const retarget::Skeleton>(std::move(joints));
  retarget::Clip clip(skeleton, retarget::FrameRate{30, 1}, 5);
  for (int frame = 0; frame < 5; ++frame) {
    for (auto& rotation : clip.rotations(frame)) {
      rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
    }
  }
  std::array<retarget::Pose, 3> poses;
  retarget::forward_kinematics(clip, 4, poses);
  const retarget::Pose end = poses[1].inverse() * poses[2];
  return std::abs(end.rotation.angularDistance(Eigen::Quaterniond::Identity()) - 0.3) < 1e-12 &&
         (poses[2].translation -
          Eigen::Vector3d(-std::sin(0.3) - std::sin(0.6), std::cos(0.3) + std::cos(0.6), 0.0))
                 .norm() < 1e-12;
}

}  // namespace

int main() {
  const std::vector<std::string> robots = {"unitree_g1", "unitree_h1"};
  if (retarget::nearest_name("unitree_G1", robots) != "unitree_g1") return 1;
  if (!poses_pass_between()) {
    std::cerr << "the library and its user lay poses out differently\n";
    return 1;
  }
  // a file without arrays
  const std::string empty = std::string("PK\x05\x06") + std::string(18, '\0');
  const auto file = retarget::NpzFile::open(empty, "empty.npz");
  if (!file || file->read("poses")) return 1;
  std::cout << retarget::version_text() << "\n";
  return 0;
}
