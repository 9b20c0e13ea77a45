// Movements that are physically impossible on this floor. A fit with the term `dynamics` completes
// with a report, and its motion is no worse by the metric than without the term.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>

#include "solve/dynamics/motion_dynamics.h"
#include "solve/fit/fit.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Files in centimetres, Y up; the root is the first joint.
struct OddMovement {
  std::string name;
  std::string clip;  // In the folder data.
  int begin, end;
  // Changes a frame at a time in seconds.
  std::function<void(double time, Quaterniond& root, Vector3d& place)> change;
};

void rise(Vector3d& place, double metres) {
  place.y() += 100.0 * metres;
}

OddMovement flying() {
  return {"flying", "walk", 60, 130,
          [](double time, Quaterniond&, Vector3d& place) { rise(place, 2.0 + 3.0 * time); }};
}

OddMovement sliding() {
  return {"sliding", "squat", 30, 110,
          [](double time, Quaterniond&, Vector3d& place) { place.x() += 60.0 * time; }};
}

OddMovement handstand() {
  return {"handstand", "wave", 0, 70, [](double, Quaterniond& root, Vector3d& place) {
            root = Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX())) * root;
            rise(place, 0.3);
          }};
}

// Backwards, with the steps of forward walking.
OddMovement moonwalk() {
  return {"moonwalk", "walk", 60, 130, [](double, Quaterniond&, Vector3d& place) {
            place.x() = -place.x();
            place.z() = -place.z();
          }};
}

OddMovement in_water() {
  return {
      "in water", "wave", 0, 90, [](double time, Quaterniond& root, Vector3d& place) {
        rise(place, 1.0 + 0.1 * std::sin(time));
        root = Quaterniond(Eigen::AngleAxisd(0.9 + 0.2 * std::sin(0.7 * time), Vector3d::UnitX())) *
               root;
      }};
}

class OddMovements : public testing::TestWithParam<OddMovement> {
 protected:
  static void SetUpTestSuite() { robot_ = load_g1(); }
  static void TearDownTestSuite() { robot_.reset(); }

  static FitResult fitted(const Clip& clip, bool dynamics) {
    FitOptions options;
    options.dynamics = dynamics;
    const auto limits = load_limits(*robot_, "official");
    FitRun run;
    // Two fits may move an arm to different branches, which changes the forces more than the term.
    run.recover_limbs = false;
    return value_of(fit(clip, lafan1_calibration(clip.skeleton()), robot_,
                        published_config(*robot_), *limits, options, run));
  }

  // Share of the time, and the mean of the missing force, in weights.
  struct Missing {
    double bad = 0.0, force = 0.0;
  };

  static Missing missing_in(const RobotClip& clip) {
    const MotionDynamics dynamics = analyse_dynamics(clip);
    Missing missing;
    const auto count = static_cast<double>(dynamics.samples.size());
    for (const DynamicsSample& sample : dynamics.samples) {
      missing.bad += sample.is_bad() ? 1.0 / count : 0.0;
      missing.force += sample.unexplained_force.norm() / count;
    }
    return missing;
  }

  static void expect_finite(const RobotClip& clip) {
    for (int t = 0; t < clip.frame_count(); ++t) {
      ASSERT_TRUE(std::ranges::all_of(clip.qpos(t), [](double q) { return std::isfinite(q); }));
    }
  }

  static std::shared_ptr<const Robot> robot_;
};
std::shared_ptr<const Robot> OddMovements::robot_;

TEST_P(OddMovements, DoNotGetWorseWithTheDynamicsTerm) {
  const OddMovement& odd = GetParam();
  Clip clip = cut(recorded_clip(odd.clip), odd.begin, odd.end);
  for (int t = 0; t < clip.frame_count(); ++t) {
    odd.change(t / 30.0, clip.rotations(t)[0], clip.translations(t)[0]);
  }
  const FitResult without = fitted(clip, false), with = fitted(clip, true);
  EXPECT_EQ(with.clip.frame_count(), clip.frame_count());
  expect_finite(with.clip);
  EXPECT_FALSE(with.report.terms.empty());
  const Missing before = missing_in(without.clip), after = missing_in(with.clip);
  EXPECT_LE(after.bad, before.bad + 0.02);
  EXPECT_LE(after.force, 1.02 * before.force + 0.005);
}

INSTANTIATE_TEST_SUITE_P(All, OddMovements,
                         testing::Values(flying(), sliding(), handstand(), moonwalk(), in_water()),
                         [](const auto& each) {
                           std::string name = each.param.name;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

TEST(OddMovement, AcceptsATPoseOfOneFrame) {
  const auto robot = load_g1();
  Clip clip = cut(recorded_clip("walk"), 0, 1);
  for (Quaterniond& rotation : clip.rotations(0)) rotation.setIdentity();
  FitOptions options;
  options.dynamics = true;
  const auto limits = load_limits(*robot, "official");
  const auto result = value_of(fit(clip, lafan1_calibration(clip.skeleton()), robot,
                                   published_config(*robot), *limits, options));
  EXPECT_EQ(result.clip.frame_count(), 1);
  EXPECT_TRUE(analyse_dynamics(result.clip).samples.empty());
}

}  // namespace
}  // namespace retarget
