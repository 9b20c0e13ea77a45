// A program of another project: calls the libraries by their public headers, with its own Eigen and
// MuJoCo types.

#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/pose.h"
#include "retarget/rig.h"
#include "retarget/robot.h"
#include "retarget/version.h"

namespace {

static_assert(alignof(retarget::Pose) == 16, "as in the library, whatever -march is here");

constexpr const char* kModel = R"(
<mujoco>
  <worldbody>
    <body name="base">
      <freejoint/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="arm" pos="0 0 1">
        <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        <joint name="elbow" axis="1 0 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>)";

// A model created by this program's MuJoCo.
std::shared_ptr<const retarget::Robot> make_robot() {
  std::array<char, 1000> error{};
  mjSpec* spec = mj_parseXMLString(kModel, nullptr, error.data(), error.size());
  if (spec == nullptr) return nullptr;
  retarget::ModelPtr model(mj_compile(spec, nullptr));
  mj_deleteSpec(spec);
  if (!model) return nullptr;
  retarget::RobotProfile profile;
  profile.name = "robot";
  return std::make_shared<const retarget::Robot>(std::move(model), std::move(profile));
}

// The library stores quaternions that this program writes, and vice versa: both must use the same
// layout, for any instruction set.
bool poses_pass_between(const retarget::Robot& robot) {
  std::vector<retarget::Joint> joints(2);
  joints[0].name = "root";
  joints[1].name = "arm";
  joints[0].parent = -1;
  joints[1].parent = 0;
  const auto skeleton = std::make_shared<const retarget::Skeleton>(std::move(joints));
  retarget::Clip clip(skeleton, retarget::FrameRate{30, 1}, 5);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
  for (int frame = 0; frame < 5; ++frame) {
    for (auto& rotation : clip.rotations(frame)) {
      if (rotation.w() != 1.0) return false;
      rotation = turned;
    }
  }
  retarget::make_sign_continuous(clip);
  const retarget::Clip end = retarget::cut(clip, 4, 5);
  for (const auto& rotation : end.rotations(0)) {
    if (rotation.coeffs() != turned.coeffs()) return false;
  }

  std::vector<double> qpos = robot.zero_configuration();
  qpos[3] = std::cos(0.15);
  qpos[4] = std::sin(0.15);
  qpos[7] = 0.2;
  std::array<retarget::Pose, 3> poses;
  retarget::forward_kinematics(robot, qpos, poses);
  const retarget::Pose arm = poses[1].inverse() * poses[2];
  return std::abs(poses[2].rotation.angularDistance(Eigen::Quaterniond::Identity()) - 0.5) <
             1e-12 &&
         (arm.translation - Eigen::Vector3d::UnitZ()).norm() < 1e-12;
}

// Round trip through the bytes of a file.
bool motion_survives(const std::shared_ptr<const retarget::Robot>& robot) {
  retarget::RobotClip clip(robot, retarget::FrameRate{50, 1}, 20);
  for (int frame = 0; frame < 20; ++frame) {
    clip.qpos(frame)[2] = 0.5;
    clip.qpos(frame)[7] = 0.01 * frame;
  }
  const auto bytes = retarget::format_robot_motion(clip, retarget::MotionFormat::kNpzMjlab);
  if (!bytes) return false;
  const auto motion = retarget::parse_robot_motion(*bytes, robot, "motion.npz");
  return motion && motion->rate_known && motion->clip.frame_count() >= 18 &&
         std::abs(motion->clip.qpos(10)[7] - 0.1) < 1e-6;
}

}  // namespace

int main() {
  const auto robot = make_robot();
  if (!robot || !poses_pass_between(*robot)) {
    std::cerr << "the library and its user lay poses out differently\n";
    return 1;
  }
  if (!motion_survives(robot)) {
    std::cerr << "a motion is another one after writing and reading\n";
    return 1;
  }
  const auto made = retarget::make_robot("not_there.xml", "robot");
  if (made || made.error().kind != retarget::ErrorKind::kConfig) return 1;
  std::cout << retarget::version_text() << "\n";
  return 0;
}
