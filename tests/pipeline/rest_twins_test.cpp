// The same movement stored with another rest pose gives the same robot motion.

#include <gtest/gtest.h>

#include <filesystem>

#include "formats/bvh/read_bvh.h"
#include "human/hand_made_maps.h"
#include "human/skeleton/calibrate.h"
#include "human/twins.h"
#include "solve/targets/solve_frames.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

RobotClip robot_motion(const Clip& clip) {
  const auto map = lafan1_map(clip.skeleton(), "test");
  const auto found = value_of(calibrate(clip, map, {}));
  const auto robot = load_g1();
  const ResolvedConfig config = published_config(*robot);
  SolveFramesOptions options;
  options.scale = ScaleRule::kLimbs;
  auto result = value_of(solve_frames(clip, found, robot, config, robot->model_limits(), options));
  return std::move(result.clip);
}

TEST(RestTwins, APoseAndIPoseGiveTheSameMotion) {
  for (const char* name : {"walk.bvh", "wave.bvh"}) {
    const std::filesystem::path data(RETARGET_SOURCE_DIR "/data");
    const Clip clip = load_bvh((data / name).string()).value().clip;
    const RobotClip of_t = robot_motion(with_t_pose_as_zero(clip));
    for (const double lowered : {0.8, M_PI / 2}) {
      const RobotClip of_twin = robot_motion(with_t_pose_as_zero(clip, lowered));
      ASSERT_EQ(of_twin.frame_count(), of_t.frame_count());
      double largest = 0.0;
      for (int frame = 0; frame < of_t.frame_count(); ++frame) {
        for (std::size_t i = 0; i < of_t.qpos(frame).size(); ++i) {
          largest = std::max(largest, std::abs(of_t.qpos(frame)[i] - of_twin.qpos(frame)[i]));
        }
      }
      EXPECT_LT(largest, 1e-6) << name << " with arms lowered by " << lowered;
    }
  }
}

}  // namespace
}  // namespace retarget
