#include "retarget/contact_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "human/gait/edit_contacts.h"
#include "human/gait/source_feet.h"
#include "retarget/error.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kEditFrames = 100;  // At 50 Hz: two seconds.

SourceFeet feet_on_floor() {
  SourceFeet source;
  source.frame_time = 0.02;
  source.foot_count = 2;
  source.feet.resize(2 * kEditFrames);
  return source;
}

// The left foot stands in the frames 10 to 30 and 50 to 70, on the floor and on a step.
ContactPlan two_stances() {
  ContactPlan plan;
  const std::vector<ContactPhase> phases = {{10, 30, 0.0}, {50, 70, 0.3}};
  for (EndContacts& end : plan.ends[0]) {
    end.phases = phases;
    end.level.assign(kEditFrames, 0);
  }
  plan.phases[0] = plan.soles[0] = phases;
  return plan;
}

ContactEdit edit(ContactAction action, const std::string& part, double start, double end,
                 double by = 0.0) {
  return {part, action, start, end, by};
}

ContactPhase phase(int begin, int end, double support = 0.0) {
  return {begin, end, support};
}

ContactPlan edited(const std::vector<ContactEdit>& edits, std::size_t idle = 0) {
  ContactPlan plan = two_stances();
  EXPECT_EQ(edit_contacts(edits, feet_on_floor(), plan).size(), idle);
  return plan;
}

TEST(ContactEdits, WithoutEditsContactsDoNotChange) {
  const ContactPlan plan = edited({});
  EXPECT_THAT(plan.phases[0], ElementsAre(phase(10, 30), phase(50, 70, 0.3)));
}

TEST(ContactEdits, RemovingTheMiddleLeavesTwoParts) {
  const ContactPlan plan = edited({edit(ContactAction::kRemove, "left_foot", 0.3, 0.4)});
  for (const auto* phases : {&plan.ends[0][kHeelEnd].phases, &plan.ends[0][kToeEnd].phases,
                             &plan.phases[0], &plan.soles[0]}) {
    EXPECT_THAT(*phases, ElementsAre(phase(10, 15), phase(20, 30), phase(50, 70, 0.3)));
  }
}

TEST(ContactEdits, AddingIsOnTheFloorAndLevel) {
  const ContactPlan plan = edited({edit(ContactAction::kAdd, "right_foot", 0.2, 0.6)});
  EXPECT_THAT(plan.phases[1], ElementsAre(phase(10, 30)));
  EXPECT_THAT(plan.soles[1], ElementsAre(phase(10, 30)));
  EXPECT_EQ(plan.ends[1][kToeEnd].level[10], 1);
  EXPECT_EQ(plan.ends[1][kToeEnd].level[30], 0);
  EXPECT_THAT(plan.phases[0], ElementsAre(phase(10, 30), phase(50, 70, 0.3)));
}

TEST(ContactEdits, AnExtendedStanceKeepsItsSurface) {
  const ContactPlan plan = edited({edit(ContactAction::kAdd, "left_foot", 1.4, 1.6)});
  EXPECT_THAT(plan.phases[0], ElementsAre(phase(10, 30), phase(50, 80, 0.3)));
}

TEST(ContactEdits, ShiftMovesWholeStances) {
  const ContactPlan plan = edited({edit(ContactAction::kShift, "left_foot", 1.1, 1.2, -0.2)});
  EXPECT_THAT(plan.phases[0], ElementsAre(phase(10, 30), phase(40, 60, 0.3)));
  const ContactPlan beyond = edited({edit(ContactAction::kShift, "left_foot", 1.1, 1.2, 0.8)});
  EXPECT_THAT(beyond.phases[0], ElementsAre(phase(10, 30), phase(90, 100, 0.3)));
}

TEST(ContactEdits, EditingOneEndDoesNotChangeTheOther) {
  const ContactPlan plan = edited({edit(ContactAction::kRemove, "left_heel", 0.4, 0.6)});
  EXPECT_THAT(plan.ends[0][kHeelEnd].phases, ElementsAre(phase(10, 20), phase(50, 70, 0.3)));
  EXPECT_THAT(plan.ends[0][kToeEnd].phases, ElementsAre(phase(10, 30), phase(50, 70, 0.3)));
  EXPECT_THAT(plan.phases[0], ElementsAre(phase(10, 20), phase(50, 70, 0.3)));
}

TEST(ContactEdits, AddContactsOfHands) {
  const ContactPlan plan = edited({edit(ContactAction::kAdd, "right_hand", 0.0, 0.2)});
  EXPECT_THAT(plan.bodies[5], ElementsAre(phase(0, 10)));
  EXPECT_THAT(plan.phases[1], IsEmpty());
}

TEST(ContactEdits, ReportsEditsWithoutEffect) {
  edited({edit(ContactAction::kRemove, "left_foot", 0.7, 0.9)}, 1);
  edited({edit(ContactAction::kShift, "right_foot", 0.0, 1.0, 0.1)}, 1);
  // The second stance ends at 1.4 s; a contact that would leave the motion stays.
  const ContactPlan plan = edited({edit(ContactAction::kShift, "left_foot", 1.1, 1.3, 1.2)}, 1);
  EXPECT_THAT(plan.phases[0], ElementsAre(phase(10, 30), phase(50, 70, 0.3)));
}

TEST(ContactEditsFile, ReadsAllFields) {
  const auto read = value_of(parse_contact_edits(
      R"({"contacts": [
          {"part": "left_foot", "action": "add", "start": 0.5, "end": 1.25, "height": 0.2},
          {"part": "right_toe", "action": "shift", "start": 0.0, "end": 1.0, "by": -0.1}]})",
      "edits.json"));
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].part, "left_foot");
  EXPECT_EQ(read[0].height, 0.2);
  EXPECT_EQ(read[1].action, ContactAction::kShift);
  EXPECT_EQ(read[1].by, -0.1);
}

TEST(ContactEditsFile, ReportsAllErrorsTogether) {
  const auto read = parse_contact_edits(
      R"({"contacts": [{"part": "left_fot", "action": "add", "start": 0, "end": 1},
                       {"part": "back", "action": "move", "start": 2, "end": 1},
                       {"part": "seat", "action": "shift", "start": 0, "end": 1}, 7]})",
      "edits.json");
  ASSERT_FALSE(read.has_value());
  EXPECT_EQ(read.error().kind, ErrorKind::kConfig);
  const std::string text = describe(read.error());
  for (const char* part : {"left_foot", "add, remove or shift", "before", "\"by\"", "edit 4"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST(ContactEditsFile, RejectsOtherJson) {
  for (const char* text : {"[]", "{}", R"({"contacts": 3})", "{", ""}) {
    EXPECT_FALSE(parse_contact_edits(text, "edits.json").has_value()) << text;
  }
}

TEST(ContactEditsFile, RejectsEditsOutsideTheMotion) {
  const std::vector<ContactEdit> edits = {edit(ContactAction::kAdd, "left_foot", 1.0, 2.0),
                                          edit(ContactAction::kAdd, "left_foot", 1.0, 2.1)};
  EXPECT_TRUE(check_contact_edits(std::span(edits).first(1), 2.0, "e").has_value());
  const auto refused = check_contact_edits(edits, 2.0, "e");
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, HasSubstr("edit 2"));
  EXPECT_THAT(refused.error().hint, HasSubstr("seconds"));
  for (const double by : {-100.0, 100.0, -1.5, 1.5}) {
    const std::vector<ContactEdit> shift = {edit(ContactAction::kShift, "left_foot", 0.5, 1.5, by)};
    const auto left = check_contact_edits(shift, 2.0, "e");
    ASSERT_FALSE(left.has_value()) << by;
    EXPECT_THAT(left.error().message, HasSubstr("outside the motion"));
  }
  const std::vector<ContactEdit> partly = {edit(ContactAction::kShift, "left_foot", 0.5, 1.5, 1.0)};
  EXPECT_TRUE(check_contact_edits(partly, 2.0, "e").has_value());
}

TEST(ContactEditsFile, RejectsByOfOtherActions) {
  const auto read = parse_contact_edits(
      R"({"contacts": [{"part": "seat", "action": "add", "start": 0, "end": 1, "by": 1}]})", "e");
  ASSERT_FALSE(read.has_value());
  EXPECT_THAT(describe(read.error()), HasSubstr("only to the action shift"));
}

}  // namespace
}  // namespace retarget
