// The up axis of joint positions of people who stay near the origin.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "formats/smpl/joint_motion.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/joint_clip.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Change = std::function<Vector3d(int frame, const Vector3d& place, const Vector3d& hips)>;

// A sample as joint positions in metres with Z up.
Clip z_up_positions(const char* sample, const Change& change) {
  const Clip clip = recorded_clip(sample);
  JointMotion motion;
  motion.frame_count = clip.frame_count();
  motion.joint_count = clip.skeleton().joint_count();
  motion.names = clip.skeleton().names();
  motion.rate = clip.rate();
  std::vector<Pose> world(static_cast<std::size_t>(motion.joint_count));
  const auto in_z_up = [](const Vector3d& at) {
    return Vector3d(0.01 * at.z(), 0.01 * at.x(), 0.01 * at.y());
  };
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    const Vector3d hips = in_z_up(world[0].translation);
    for (const Pose& pose : world) {
      motion.positions.push_back(change(frame, in_z_up(pose.translation), hips));
    }
  }
  return clip_of_joints(motion, "positions.npy").value();
}

Vector3d up_of(const Clip& clip) {
  const BoneMap map = lafan1_map(clip.skeleton(), "test");
  return calibrate(clip, map, {}).value().human_from_source.row(2).transpose();
}

TEST(UpOfPositions, SquatsStand) {
  const Clip clip =
      z_up_positions("squat", [](int, const Vector3d& place, const Vector3d&) { return place; });
  EXPECT_GT(up_of(clip).z(), 0.99);
}

// Noise of the hips does not place a centred body.
TEST(UpOfPositions, NoiseDoesNotLayDownACentredBody) {
  const Clip clip = z_up_positions(
      "walk", [](int frame, const Vector3d& place, const Vector3d& hips) -> Vector3d {
        return place - hips + 0.01 * Vector3d(std::sin(9.0 * frame), std::cos(7.0 * frame), 0.0);
      });
  EXPECT_GT(up_of(clip).z(), 0.99);
}

// World coordinates of video estimates are tilted, and streets have slopes. Along y, the sides of the
// body then stay nearer to one height than the feet do along z.
TEST(UpOfPositions, AWalkOnASlopeStands) {
  for (const double degrees : {-12.0, -2.0, 2.0, 12.0}) {
    const Eigen::AngleAxisd tilt(degrees * M_PI / 180.0, Vector3d::UnitY());
    EXPECT_GT(up_of(z_up_positions("walk", [&](int, const Vector3d& place,
                                               const Vector3d&) { return Vector3d(tilt * place); }))
                  .z(),
              0.99)
        << degrees;
  }
  const Clip climbing =
      z_up_positions("walk", [](int, const Vector3d& place, const Vector3d& hips) {
        return Vector3d(place + Vector3d(0.0, 0.0, 0.04 * hips.x()));
      });
  EXPECT_GT(up_of(climbing).z(), 0.99);
}

// The feet of a squat rise if its hips stay at the origin.
TEST(UpOfPositions, ACentredSquatStands) {
  const Clip clip = z_up_positions("squat", [](int, const Vector3d& place, const Vector3d& hips) {
    return Vector3d(place - hips);
  });
  EXPECT_GT(up_of(clip).z(), 0.99);
}

}  // namespace
}  // namespace retarget
