#include "human/skeleton/units.h"
#include "base/option_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "human/hand_made_maps.h"
#include "human/tiny_skeleton.h"
#include "human/twins.h"
#include "support/recorded_clip.h"
#include "support/value_of.h"
#include "support/with_joints.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(GuessUnit, FindsUnitFromHipHeight) {
  for (const double metres : {0.76, 0.9, 1.1}) {
    EXPECT_EQ(guess_unit(metres)->name, "m");
    EXPECT_EQ(guess_unit(metres * 10)->name, "dm");
    EXPECT_EQ(guess_unit(metres * 100)->name, "cm");
    EXPECT_EQ(guess_unit(metres * 1000)->name, "mm");
    EXPECT_EQ(guess_unit(metres / 0.0254)->name, "inch");
    EXPECT_EQ(guess_unit(metres / 0.056444)->name, "CMU unit");
  }
}

// A child of 0.9 to 1.05 m has its hips at 0.47 to 0.55 m.
TEST(GuessUnit, HandlesChildren) {
  for (const double metres : {0.47, 0.5, 0.515, 0.53, 0.55}) {
    EXPECT_EQ(guess_unit(metres)->name, "m") << metres;
    EXPECT_EQ(guess_unit(metres * 10)->name, "dm") << metres;
    EXPECT_EQ(guess_unit(metres * 100)->name, "cm") << metres;
    EXPECT_EQ(guess_unit(metres * 1000)->name, "mm") << metres;
  }
}

TEST(GuessUnit, RejectsImplausibleHeights) {
  for (const double height : {0.0, 0.3, 3.0, 200.0, 5000.0, -90.0}) {
    EXPECT_FALSE(guess_unit(height)) << height;
  }
}

TEST(UnitOfBody, UsesSkeletonUnitIfPlausible) {
  EXPECT_EQ(unit_of_body({90.0, 170.0, 0.0127, {}})->metres, 0.0127);
  EXPECT_EQ(unit_of_body({90.0, 170.0, 0.0254, {}})->name, "cm");
  EXPECT_FALSE(unit_of_body({191.9, 360.0, 0.01, {}}));
}

// A character of 0.78 m in centimetres would be a tall adult in inches.
TEST(UnitOfBody, UsesSkeletonUnitForSmallChildren) {
  EXPECT_EQ(unit_of_body({41.7, 78.0, 0.01, {}})->name, "cm");
  EXPECT_EQ(unit_of_body({37.4, 71.0, 0.01, {}})->name, "cm");
  // An adult of 1.75 m in inches.
  EXPECT_EQ(unit_of_body({37.4, 69.0, 0.01, {}})->name, "inch");
  EXPECT_EQ(unit_of_body({41.7, 78.0, {}, {}})->name, "inch");
  EXPECT_EQ(unit_of_body({35.0, 65.0, 0.01, {}})->name, "inch");
  EXPECT_EQ(unit_of_body({41.7, 78.0, 0.01, 1.95})->name, "inch");
}

TEST(UnitOfBody, IsDeterminedByAGivenHeight) {
  // A character at double scale.
  const auto doubled = unit_of_body({191.9, 360.0, 0.01, 1.8}).value();
  EXPECT_EQ(doubled.name, "scaled");
  EXPECT_DOUBLE_EQ(doubled.metres, 0.005);
  // A given height overrides the usual range, even that of a giant.
  EXPECT_EQ(unit_of_body({191.9, 360.0, {}, 3.5})->name, "cm");
  // A unit that nearly gives the height is correct: heights are estimates.
  EXPECT_EQ(unit_of_body({90.0, 165.0, {}, 1.8})->name, "cm");
  EXPECT_EQ(unit_of_body({45.0, 84.0, {}, 0.85})->name, "cm");
  EXPECT_EQ(unit_of_body({48.0, 89.0, {}, 2.2})->name, "inch");
  // A body in a known unit is not scaled: its height determines the scale of the targets.
  EXPECT_EQ(unit_of_body({93.0, 175.0, 0.01, 1.1})->name, "cm");
}

Clip sample_in(double scale, bool with_lafan1_axes) {
  const Clip clip = recorded_clip("walk");
  return scaled_and_turned(with_lafan1_axes ? clip : with_t_pose_as_zero(clip), scale,
                           Eigen::Quaterniond::Identity());
}

Result<Calibration> calibrated_in_units(const Clip& clip, bool with_lafan1_axes,
                                        const CalibrationOptions& options) {
  return calibrate(clip, lafan1_map(clip.skeleton(), with_lafan1_axes ? "lafan1" : "test"),
                   options);
}

TEST(CalibrateSize, RejectsUnknownUnitUnlessHeightIsGiven) {
  for (const bool lafan1 : {false, true}) {
    SCOPED_TRACE(lafan1);
    const Clip twice = sample_in(2.0, lafan1);
    const auto refused = calibrated_in_units(twice, lafan1, {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().hint, HasSubstr(OPTION("unit")));
    EXPECT_THAT(refused.error().hint, HasSubstr(OPTION("height")));
    CalibrationOptions told;
    told.height = 1.75;
    const auto found = value_of(calibrated_in_units(twice, lafan1, told));
    EXPECT_EQ(found.unit, "scaled");
    EXPECT_EQ(found.height, 1.75);
    EXPECT_NEAR(found.metres_per_unit, 0.005, 2e-4);
    EXPECT_THAT(found.doubts, IsEmpty());
  }
}

TEST(CalibrateSize, DoubtsAGivenUnitThatMakesAGiant) {
  for (const auto& [unit, is_doubted] :
       {std::pair{0.01, false}, {0.012, false}, {0.0254, true}, {0.001, true}}) {
    CalibrationOptions told;
    told.metres_per_unit = unit;
    const auto found = value_of(calibrated_in_units(sample_in(1.0, false), false, told));
    EXPECT_EQ(found.doubts.size(), is_doubted ? 1U : 0U) << unit;
    // A given height is the user's statement about the body.
    told.height = 1.75;
    EXPECT_THAT(calibrated_in_units(sample_in(1.0, false), false, told)->doubts, IsEmpty());
  }
}

TEST(CalibrateSize, OptionalUnitAssumesAnAverageBody) {
  for (const bool lafan1 : {false, true}) {
    CalibrationOptions any;
    any.unit_optional = true;
    const Clip twice = sample_in(2.0, lafan1);
    const auto found = value_of(calibrated_in_units(twice, lafan1, any));
    EXPECT_EQ(found.unit, "unknown");
    EXPECT_NEAR(found.height, 1.7, 0.051);
    ASSERT_EQ(found.doubts.size(), 1U);
    EXPECT_THAT(found.doubts[0].message, HasSubstr("no known unit"));
    EXPECT_EQ(calibrated_in_units(sample_in(1.0, lafan1), lafan1, any)->unit, "cm");
  }
}

TEST(CalibrateSize, SmallMixamoCharacterIsInCentimetres) {
  const Clip small = sample_in(0.45, false);
  std::vector<Joint> joints = small.skeleton().joints();
  for (Joint& joint : joints) {
    joint.name = "mixamorig:" + joint.name;
    if (joint.name.ends_with("Toe")) joint.name += "Base";
  }
  const Clip clip = with_joints(small, joints);
  const auto map = value_of(recognise_skeleton(clip, shipped_profiles()));
  EXPECT_EQ(map.profile, "mixamo");
  const auto found = value_of(calibrate(clip, map, {}));
  EXPECT_EQ(found.unit, "cm");
  EXPECT_NEAR(found.height, 1.72 * 0.45, 0.03);
  // The size is unusual, which causes a warning.
  ASSERT_FALSE(found.doubts.empty());
  EXPECT_THAT(found.doubts.back().message, HasSubstr("height"));
  // A character of 5.7 m is scaled by its proportions.
  for (Joint& joint : joints) joint.offset *= 3.3 / 0.45;
  Clip giant = with_joints(small, joints);
  for (int frame = 0; frame < giant.frame_count(); ++frame) {
    giant.translations(frame)[0] *= 3.3 / 0.45;
  }
  const auto taken = value_of(calibrate(giant, map, {}));
  EXPECT_NEAR(taken.height, 1.7, 0.051);
  EXPECT_THAT(taken.doubts.at(0).message, HasSubstr("no known unit"));
}

// Blender's default scale makes hips 9,300 units high, or 0.93 if the file states centimetres.
TEST(CalibrateSize, AcceptsScenesOfAnyScaleByTheirProportions) {
  for (const double scale : {1e-4, 0.03, 2.2, 3.3, 100.0}) {
    SCOPED_TRACE(scale);
    Clip clip = sample_in(scale, false);
    EXPECT_FALSE(calibrated_in_units(clip, false, {}));
    ClipOrigin origin;
    origin.metres_per_unit = 0.01;
    clip.set_origin(origin);
    const auto found = value_of(calibrated_in_units(clip, false, {}));
    EXPECT_EQ(found.unit, "unknown");
    EXPECT_NEAR(found.height, 1.7, 0.051);
    ASSERT_EQ(found.doubts.size(), 1U);
    EXPECT_THAT(found.doubts[0].message, HasSubstr("scaled to a body height of 1.70 m"));
  }
  EXPECT_TRUE(has_human_proportions(0.93, 1.72));
  EXPECT_TRUE(has_human_proportions(9300.0, 17200.0));
  // A stick with legs, and a body without them.
  EXPECT_FALSE(has_human_proportions(1.0, 1.1));
  EXPECT_FALSE(has_human_proportions(0.0, 1.7));
}

TEST(CalibrateSize, ChildWithLafan1NamesKeepsItsOwnHeight) {
  const auto adult = calibrated_in_units(sample_in(1.0, true), true, {}).value();
  for (const double scale : {0.6, 0.8, 0.9, 1.1}) {
    const Clip clip = sample_in(scale, true);
    const auto found = value_of(calibrated_in_units(clip, true, {}));
    EXPECT_EQ(found.unit, "cm");
    EXPECT_NEAR(found.height, 1.75 * scale, 0.035 * scale) << scale;
    EXPECT_NE(found.rest_pose, "lafan1");
    EXPECT_THAT(found.description,
                HasSubstr("body height " + std::to_string(found.height).substr(0, 3)));
    // Its axes are still LAFAN1's.
    const HumanClip human = to_human(clip, found);
    const HumanClip grown = to_human(sample_in(1.0, true), adult);
    EXPECT_LT(human.frame(7)[Bone::kLeftArm].rotation.angularDistance(
                  grown.frame(7)[Bone::kLeftArm].rotation),
              1e-9);
  }
  // Heights within the variation of one data set keep the published height.
  for (const double scale : {0.995, 1.0, 1.01}) {
    const auto found = calibrated_in_units(sample_in(scale, true), true, {}).value();
    EXPECT_EQ(found.height, 1.75) << scale;
    EXPECT_EQ(found.rest_pose, "lafan1") << scale;
  }
}

}  // namespace
}  // namespace retarget
