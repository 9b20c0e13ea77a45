// Ends of feet that rise while they are in contact.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "fit/moving_feet.h"
#include "solve/fit/foot_plan.h"

namespace retarget {
namespace {

// Stands, and raises the heel slowly to `rise` metres for a second while the toe stays.
SourceFeet on_tiptoe(double rise) {
  SourceFeet feet = make_feet(5.0, 30.0, [](double) { return FootPlace{}; });
  for (std::size_t frame = 0; frame < feet.feet.size(); ++frame) {
    const double up = std::clamp(1.5 - std::abs(static_cast<double>(frame) / 30.0 - 2.5), 0.0, 1.0);
    feet.feet[frame].ankle.z() += rise * up;
  }
  return feet;
}

TEST(RisingFeet, SlowlyRisingHeelLeavesTheFloor) {
  const FootPlan plan = plan_of(on_tiptoe(0.04));
  const auto heel = [&](int frame) { return plan.ends_of(frame)[kHeelEnd]; };
  EXPECT_EQ(heel(15).lift, 0.0);
  EXPECT_GE(heel(75).phase, 0);
  EXPECT_EQ(heel(75).lift, 1.0);
  EXPECT_NEAR(heel(75).clearance, 0.04, 1e-12);
  EXPECT_EQ(plan.ends_of(75)[kToeEnd].lift, 0.0);
}

TEST(RisingFeet, FootThatIsWhollyHigherStaysOnItsSurface) {
  // Stands three centimetres higher after a step, as on a mat.
  const SourceFeet feet = make_feet(8.0, 30.0, [](double t) {
    FootPlace place = step(t);
    if (t > 1.3) place.height = std::max(place.height, 0.03);
    return place;
  });
  const FootPlan plan = plan_of(feet);
  for (const int end : {kHeelEnd, kToeEnd}) {
    EXPECT_EQ(plan.ends_of(150)[static_cast<std::size_t>(end)].lift, 0.0);
  }
}

TEST(RisingFeet, FlatFootStaysOnTheFloorWithLowContacts) {
  const SourceFeet feet = make_feet(3.0, 30.0, [](double) { return FootPlace{}; });
  FitOptions low;
  low.contact_height = 0.02;
  const ContactOptions options = contact_options(low);
  FootPlan plan;
  plan_feet(feet, find_contacts(feet, options), options, std::array{0}, 1.0, {}, plan);
  EXPECT_EQ(plan.ends_of(45)[kHeelEnd].lift, 0.0);
  EXPECT_EQ(plan.ends_of(45)[kToeEnd].lift, 0.0);
}

TEST(RisingFeet, SlightlyRaisedHeelStaysOnTheFloor) {
  EXPECT_EQ(plan_of(on_tiptoe(0.008)).ends_of(75)[kHeelEnd].lift, 0.0);
  const double lift = plan_of(on_tiptoe(0.015)).ends_of(75)[kHeelEnd].lift;
  EXPECT_GT(lift, 0.0);
  EXPECT_LT(lift, 1.0);
}

}  // namespace
}  // namespace retarget
