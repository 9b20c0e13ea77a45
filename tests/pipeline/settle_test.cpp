// The settled first frame of a run.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "formats/bvh/read_bvh.h"
#include "solve/targets/solve_frames.h"
#include "support/lafan1_map.h"
#include "support/shared_data.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

const std::filesystem::path kRoot = RETARGET_SOURCE_DIR;

// Repeats the first frame of a clip.
Clip first_frame(const std::filesystem::path& bvh, int frames) {
  const auto file = value_of(load_bvh(bvh.string()));
  Clip clip = cut(file.clip, 0, frames);
  for (int frame = 1; frame < frames; ++frame) {
    std::ranges::copy(clip.rotations(0), clip.rotations(frame).begin());
    std::ranges::copy(clip.translations(0), clip.translations(frame).begin());
  }
  return clip;
}

RobotClip solved(const Clip& clip, const std::string& name,
                 const std::shared_ptr<const Robot>& robot, bool settle) {
  const auto config =
      value_of(load_config((kRoot / "configs" / ("lafan1_to_" + name + ".json")).string(), *robot));
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  SolveFramesOptions options;
  options.settle = settle;
  const auto result =
      value_of(solve_frames(clip, calibration, robot, config, robot->model_limits(), options));
  return result.clip;
}

// Joint movement between the first and the last frame.
double way(const RobotClip& clip) {
  double max = 0.0;
  for (std::size_t i = 7; i < clip.qpos(0).size(); ++i) {
    max = std::max(max, std::abs(clip.qpos(clip.frame_count() - 1)[i] - clip.qpos(0)[i]));
  }
  return max;
}

// Frames may still change for two seconds; the callback receives them when they are final.
TEST(SettledRun, ReportsEveryFrameOnceInOrder) {
  const auto robot = load_g1();
  const auto config = load_config((kRoot / "robots/unitree_g1/ik.json").string(), *robot);
  const Clip whole = load_bvh((kRoot / "data/wave.bvh").string())->clip;
  for (const int frames : {0, 1, 59, 60, 61, 121}) {
    const Clip clip = cut(whole, 0, frames);
    const Calibration calibration = lafan1_calibration(clip.skeleton());
    SolveFramesOptions options;
    options.settle = true;
    options.scale = ScaleRule::kLimbs;
    options.trunk = TrunkRule::kLines;
    std::vector<std::vector<double>> told;
    options.frame_solved = [&](int frame, std::span<const double> qpos) {
      EXPECT_EQ(frame, static_cast<int>(told.size()));
      told.emplace_back(qpos.begin(), qpos.end());
    };
    for (const bool ahead : {false, true}) {
      told.clear();
      options.targets_ahead = ahead;
      const auto result =
          value_of(solve_frames(clip, calibration, robot, *config, robot->model_limits(), options));
      ASSERT_EQ(static_cast<int>(told.size()), frames);
      for (int frame = 0; frame < frames; ++frame) {
        EXPECT_TRUE(
            std::ranges::equal(told[static_cast<std::size_t>(frame)], result.clip.qpos(frame)))
            << frame << " of " << frames;
      }
    }
  }
}

TEST(SettledFirstFrame, FirstFrameHasConverged) {
  const auto robot = load_g1();
  const Clip clip = first_frame(kRoot / "data" / "get_up.bvh", 20);
  const double published = way(solved(clip, "unitree_g1", robot, false));
  const double settled = way(solved(clip, "unitree_g1", robot, true));
  EXPECT_LT(settled, 2e-3);
  EXPECT_GT(published, 3.0 * settled);
}

TEST(SettledFirstFrame, DoesNotJamALimbAtItsLimits) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  const auto robot = load_robot_in(kRoot / "robots" / "stanford_toddy");
  const Clip source = first_frame(*shared / "data" / "lafan1" / "dance1_subject2.bvh", 1);
  const RobotClip clip = solved(source, "stanford_toddy", robot, true);
  // From all joints at 0, two joints of the right shoulder end at their limits and stay there.
  int at_limits = 0;
  for (const char* name : {"right_sho_pitch", "right_sho_roll", "right_sho_yaw"}) {
    const int joint = robot->find_joint(name).value();
    const auto index = static_cast<std::size_t>(joint);
    const double value =
        clip.qpos(0)[static_cast<std::size_t>(robot->joints()[index].qpos_address)];
    if (value < robot->model_limits().lower[index] + 1e-3) ++at_limits;
    if (value > robot->model_limits().upper[index] - 1e-3) ++at_limits;
  }
  EXPECT_LT(at_limits, 2);
}

}  // namespace
}  // namespace retarget
