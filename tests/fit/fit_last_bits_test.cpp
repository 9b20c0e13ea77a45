// The last bits of a source must not decide between branches of the fit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/bvh/read_bvh.h"
#include "solve/fit/fit.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// For nearly stretched limbs, the first stage amplifies these bits to at most 1e-9, and a step of
// the fit perhaps tenfold. Without a change of branch, the printed files are equal.
constexpr double kBits = 1e-12, kSameMotion = 1e-6;

// A clip with changed last bits in every rotation.
Clip with_other_bits(Clip clip) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> bits(-kBits, kBits);
  for (int t = 0; t < clip.frame_count(); ++t) {
    for (auto& rotation : clip.rotations(t)) {
      rotation = Eigen::Quaterniond(1.0, bits(random), bits(random), bits(random)) * rotation;
    }
  }
  return clip;
}

// Largest difference of two motions.
double difference(const RobotClip& a, const RobotClip& b) {
  double max = 0.0;
  for (int t = 0; t < a.frame_count(); ++t) {
    for (std::size_t i = 0; i < a.qpos(t).size(); ++i) {
      max = std::max(max, std::abs(a.qpos(t)[i] - b.qpos(t)[i]));
    }
  }
  return max;
}

// Distance between the fits of a clip and of its copy.
double apart(const std::shared_ptr<const Robot>& robot, const std::string& config_file,
             const Clip& clip) {
  const auto config = value_of(load_config(RETARGET_SOURCE_DIR "/configs/" + config_file, *robot));
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  const auto run = [&](const Clip& source) {
    auto result = value_of(fit(source, calibration, robot, config, robot->model_limits()));
    return std::move(result.clip);
  };
  return difference(run(clip), run(with_other_bits(clip)));
}

TEST(FitLastBits, FloorContactsAreStableToRounding) {
  // Starts are lifted until their lowest point is exactly on the floor.
  EXPECT_LT(apart(load_g1(), "lafan1_to_unitree_g1.json", cut(recorded_clip("get_up"), 50, 100)),
            kSameMotion);
}

TEST(FitLastBits, FootContactsAreStableToRounding) {
  // Boxes with parallel faces: Talos' feet overlap where the source's do not.
  EXPECT_LT(apart(load_robot_in(RETARGET_SOURCE_DIR "/robots/pal_talos"),
                  "lafan1_to_pal_talos.json", cut(recorded_clip("squat"), 0, 20)),
            kSameMotion);
}

TEST(FitLastBits, BodyContactsAreStableToRounding) {
  // A body that lies symmetrically: several points of the torso are equally low.
  EXPECT_LT(apart(load_robot_in(RETARGET_SOURCE_DIR "/robots/booster_t1"),
                  "lafan1_to_booster_t1.json", cut(recorded_clip("get_up"), 0, 100)),
            kSameMotion);
}

}  // namespace
}  // namespace retarget
