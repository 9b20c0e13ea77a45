#include "solve/fit/frame_damping.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "fit/fit_model_test_base.h"

namespace retarget {
namespace {

constexpr std::size_t kHeight = 2, kTurn = 3;  // Degrees of freedom of the root.

class FrameDampingTest : public FitModelTest {
 protected:
  void SetUp() override {
    FitModelTest::SetUp();
    damping_.emplace(model_, 2, false);
    damping_->adapt(0, 100.0);
  }

  // Damping of a frame whose cost has risen, beyond that of one without steps.
  double added(std::size_t dof, double diagonal) const {
    return damping_->of(0, dof, diagonal) - damping_->of(1, dof, diagonal);
  }

  std::optional<FrameDamping> damping_;
};

TEST_F(FrameDampingTest, DampsAFrameWhoseCostRises) {
  EXPECT_EQ(added(kTurn, 50.0), 0.0);
  damping_->adapt(0, 200.0);
  const double first = added(kTurn, 50.0);
  EXPECT_GT(first, 0.0);
  damping_->adapt(0, 300.0);
  EXPECT_GT(added(kTurn, 50.0), 2.0 * first);
  damping_->adapt(0, 250.0);
  EXPECT_LT(added(kTurn, 50.0), 4.0 * first);
}

TEST_F(FrameDampingTest, IgnoresTheCurvatureOfContacts) {
  damping_->adapt(0, 200.0);
  EXPECT_DOUBLE_EQ(added(kTurn, 500.0), 2.0 * added(kTurn, 250.0));
  EXPECT_EQ(added(kTurn, 1e6), added(kTurn, 1e4));
  EXPECT_EQ(added(kHeight, 1e8), added(kHeight, 1e6));
  EXPECT_GT(added(kHeight, 1e6), added(kTurn, 1e6));
}

TEST_F(FrameDampingTest, MovesWithTheWindow) {
  damping_->adapt(0, 200.0);
  damping_->move(1, 2);
  EXPECT_EQ(damping_->state().factors, (std::vector{0.0, 0.0}));
}

}  // namespace
}  // namespace retarget
