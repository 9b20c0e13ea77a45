// Repeated plans equal those of a new planner, without additional memory.

#include "human/gait/contact_plan.h"

#include <gtest/gtest.h>

#include <string>

#include "retarget/human.h"
#include "support/counted_allocations.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

SourceFeet feet_of(const std::string& name) {
  const HumanClip human = lafan1_human(recorded_clip(name));
  return {human, human.frame_count};
}

void expect_equal(const ContactPlan& found, const ContactPlan& expected, const std::string& what) {
  EXPECT_EQ(found.scale, expected.scale) << what;
  EXPECT_EQ(found.standing.ankle, expected.standing.ankle) << what;
  EXPECT_EQ(found.standing.toe, expected.standing.toe) << what;
  EXPECT_EQ(found.standing.found, expected.standing.found) << what;
  EXPECT_EQ(found.phases, expected.phases) << what;
  EXPECT_EQ(found.soles, expected.soles) << what;
  EXPECT_EQ(found.bodies, expected.bodies) << what;
  for (std::size_t foot = 0; foot < 2; ++foot) {
    for (std::size_t end = 0; end < 2; ++end) {
      EXPECT_EQ(found.ends[foot][end].phases, expected.ends[foot][end].phases) << what;
      EXPECT_EQ(found.ends[foot][end].level, expected.ends[foot][end].level) << what;
    }
  }
}

TEST(ContactPlanner, IsIndependentOfEarlierClips) {
  ContactPlanner planner;
  SourceFeet none = feet_of("walk");
  none.foot_count = 0;
  SourceFeet no_toes = feet_of("walk");
  no_toes.has_toe = {false, false};
  for (const char* name : {"get_up", "walk", "squat", "wave", "turn_in_place"}) {
    const SourceFeet source = feet_of(name);
    for (const bool goes_on : {false, true}) {
      ContactOptions options;
      options.goes_on = goes_on;
      expect_equal(planner.plan(source, options), find_contacts(source, options), name);
    }
    expect_equal(planner.plan(no_toes), find_contacts(no_toes), "without toes");
    expect_equal(planner.plan(none), find_contacts(none), "without feet");
  }
}

TEST(ContactPlanner, ReusesItsBuffers) {
  for (const char* name : {"get_up", "walk"}) {
    const SourceFeet source = feet_of(name);
    ContactPlanner planner;
    planner.reserve(source.frame_count());
    const long before = allocations;
    const ContactPlan& plan = planner.plan(source);
    EXPECT_EQ(allocations, before) << name;
    EXPECT_FALSE(plan.ends[0][kToeEnd].phases.empty()) << name;
  }
}

}  // namespace
}  // namespace retarget
