// The fit of a body that kneels, leans on its hands and gets up: supporting parts lie on the floor
// and stay in place.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "retarget/statistics.h"
#include "solve/dynamics/motion_dynamics.h"
#include "solve/fit/fit.h"
#include "solve/targets/support_bodies.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

struct Supports {
  std::vector<double> heights, slips;  // m by frame, m/s by step
};

class BodyContactTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { robot_ = load_g1(); }
  static void TearDownTestSuite() { robot_.reset(); }

  FitResult fitted(const FitOptions& options, int begin = 60, int end = 140) {
    const Clip part = cut(recorded_clip("get_up"), begin, end);
    const auto limits = load_limits(*robot_, "official");
    return value_of(fit(part, lafan1_calibration(part.skeleton()), robot_,
                        published_config(*robot_), *limits, options));
  }

  // Measures the robot's supports in phases in which their counterparts support the human.
  static Supports measure(const FitResult& result) {
    Supports found;
    TreeState state(robot_->tree());
    for (const SupportBody& body : support_bodies(*robot_, published_config(*robot_))) {
      for (const ContactPhase& phase : result.contacts.bodies[body.support]) {
        Eigen::Vector3d before = Eigen::Vector3d::Zero();
        for (int t = phase.begin; t < phase.end; ++t) {
          state.update(result.clip.qpos(t));
          const Eigen::Vector3d middle =
              state.world_from_link[static_cast<std::size_t>(body.link)] * body.middle;
          double height = std::numeric_limits<double>::infinity();
          for (const SupportBody::Point& point : body.points) {
            const auto link = static_cast<std::size_t>(point.link);
            height =
                std::min(height, (state.world_from_link[link] * point.in_link).z() - point.radius);
          }
          found.heights.push_back(height);
          if (t > phase.begin) found.slips.push_back((middle - before).head<2>().norm() * 30.0);
          before = middle;
        }
      }
    }
    return found;
  }

  static double bad_share(const RobotClip& clip) {
    const MotionDynamics dynamics = analyse_dynamics(clip);
    const auto bad = std::ranges::count_if(dynamics.samples, &DynamicsSample::is_bad);
    return static_cast<double>(bad) / static_cast<double>(dynamics.samples.size());
  }

  static std::shared_ptr<const Robot> robot_;
};
std::shared_ptr<const Robot> BodyContactTest::robot_;

TEST_F(BodyContactTest, HandsAndKneesLieOnTheFloorAndStay) {
  FitOptions nothing;
  nothing.body_contact_weight = nothing.body_contact_height_weight = 0.0;
  const FitResult without = fitted(nothing), with = fitted({});
  const Supports before = measure(without), after = measure(with);
  ASSERT_GT(after.heights.size(), 40U);
  EXPECT_GT(median(before.heights), 0.02);
  EXPECT_LT(median(after.heights), 0.6 * median(before.heights));
  EXPECT_LT(median(after.heights), 0.018);
  EXPECT_LT(percentile(after.heights, 95.0), 0.04);
  EXPECT_GT(*std::ranges::min_element(after.heights), -0.01);
  EXPECT_LT(mean(after.slips), 0.6 * mean(before.slips));
  EXPECT_LT(bad_share(with.clip), 0.8 * bad_share(without.clip));
}

TEST_F(BodyContactTest, PlantsNothingWithoutContacts) {
  FitOptions options;
  options.contact = false;
  FitOptions nothing = options;
  nothing.body_contact_weight = nothing.body_contact_height_weight = 0.0;
  const FitResult a = fitted(options, 60, 90), b = fitted(nothing, 60, 90);
  for (int t = 0; t < a.clip.frame_count(); ++t) {
    EXPECT_TRUE(std::ranges::equal(a.clip.qpos(t), b.clip.qpos(t)));
  }
}

TEST_F(BodyContactTest, IsIndependentOfTheThreadCount) {
  FitOptions one, three;
  one.window = three.window = 1.0;
  one.seam = three.seam = 0.2;
  one.threads = 1;
  three.threads = 3;
  const FitResult a = fitted(one), b = fitted(three);
  for (int t = 0; t < a.clip.frame_count(); ++t) {
    EXPECT_TRUE(std::ranges::equal(a.clip.qpos(t), b.clip.qpos(t))) << t;
  }
}

}  // namespace
}  // namespace retarget
