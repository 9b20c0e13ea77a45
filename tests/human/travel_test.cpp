// Scaled travel: shorter paths over the ground on which feet still stand.

#include "human/gait/travel.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "formats/bvh/read_bvh.h"
#include "human/gait/contact_plan.h"
#include "retarget/human.h"
#include "support/accelerated.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

TravelReport scale(Clip& clip, const TravelRule& rule) {
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  return scale_travel(clip, 0, {0, clip.frame_count()}, calibration, rule);
}

TravelRule constant(double factor) {
  return {factor, factor, 0.0, 0.0};
}

Vector3d place(const HumanClip& human, int frame, Bone bone) {
  return human.frame(frame)[bone].translation;
}

Vector2d way(const HumanClip& human, int frame, Bone bone) {
  return (place(human, frame, bone) - place(human, 0, bone)).head<2>();
}

bool is_same(const Clip& a, const Clip& b) {
  const auto same_turn = [](const Eigen::Quaterniond& p, const Eigen::Quaterniond& q) {
    return p.coeffs() == q.coeffs();
  };
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    if (!std::ranges::equal(a.rotations(frame), b.rotations(frame), same_turn) ||
        !std::ranges::equal(a.translations(frame), b.translations(frame))) {
      return false;
    }
  }
  return true;
}

// Largest distance, metres, between the displacements of a foot end within a stance.
double largest_slide(const HumanClip& before, const HumanClip& after) {
  const ContactPlan contacts = find_contacts(before);
  double slide = 0.0;
  for (int foot = 0; foot < 2; ++foot) {
    for (const auto& [end, part] :
         {std::pair(kHeelEnd, LimbBone::kFoot), {kToeEnd, LimbBone::kToe}}) {
      const Bone bone = side_bone(kSides[static_cast<std::size_t>(foot)], part);
      const auto moved = [&](int frame) -> Vector3d {
        return place(after, frame, bone) - place(before, frame, bone);
      };
      for (const ContactPhase& phase :
           contacts.ends[static_cast<std::size_t>(foot)][static_cast<std::size_t>(end)].phases) {
        for (int frame = phase.begin; frame < phase.end; ++frame) {
          slide = std::max(slide, (moved(frame) - moved(phase.begin)).norm());
        }
      }
    }
  }
  return slide;
}

TEST(Travel, ConstantFactorScalesThePathOfTheHips) {
  const Clip walk = recorded_clip("walk");
  Clip scaled = walk;
  const TravelReport report = scale(scaled, constant(0.9));
  EXPECT_DOUBLE_EQ(report.factor, 0.9);
  EXPECT_DOUBLE_EQ(report.least, 0.9);
  EXPECT_DOUBLE_EQ(report.greatest, 0.9);
  const HumanClip before = lafan1_human(walk), after = lafan1_human(scaled);
  ASSERT_GT(way(before, walk.frame_count() - 1, Bone::kHips).norm(), 2.0);
  for (int frame = 0; frame < walk.frame_count(); ++frame) {
    EXPECT_NEAR((way(after, frame, Bone::kHips) - 0.9 * way(before, frame, Bone::kHips)).norm(),
                0.0, 1e-9);
    EXPECT_NEAR(place(after, frame, Bone::kHips).z(), place(before, frame, Bone::kHips).z(), 1e-9);
    EXPECT_LT(before.frame(frame)[Bone::kHips].rotation.angularDistance(
                  after.frame(frame)[Bone::kHips].rotation),
              1e-6);
  }
}

TEST(Travel, FeetThatStandStillDoSoAfterwards) {
  const Clip walk = recorded_clip("walk");
  Clip scaled = walk;
  scale(scaled, constant(0.9));
  // Without planting it would be 4 cm. Legs that are nearly straight miss a little.
  EXPECT_LT(largest_slide(lafan1_human(walk), lafan1_human(scaled)), 2e-3);
}

TEST(Travel, FeetKeepHeightAndPitch) {
  const Clip walk = recorded_clip("walk");
  Clip scaled = walk;
  scale(scaled, constant(0.85));
  const HumanClip before = lafan1_human(walk), after = lafan1_human(scaled);
  for (int frame = 0; frame < walk.frame_count(); ++frame) {
    for (const Bone foot : {Bone::kLeftFoot, Bone::kRightFoot}) {
      EXPECT_NEAR(place(after, frame, foot).z(), place(before, frame, foot).z(), 2e-3);
      EXPECT_LT(
          before.frame(frame)[foot].rotation.angularDistance(after.frame(frame)[foot].rotation),
          1e-6);
    }
  }
}

TEST(Travel, StepsAreShorterInProportion) {
  const Clip walk = recorded_clip("walk");
  Clip scaled = walk;
  scale(scaled, constant(0.8));
  const HumanClip before = lafan1_human(walk), after = lafan1_human(scaled);
  const int last = walk.frame_count() - 1;
  for (const Bone foot : {Bone::kLeftFoot, Bone::kRightFoot}) {
    const double ratio = way(after, last, foot).norm() / way(before, last, foot).norm();
    EXPECT_NEAR(ratio, 0.8, 0.02);
  }
}

TEST(Travel, FactorsOfOneChangeNothing) {
  const Clip walk = recorded_clip("walk");
  Clip scaled = walk;
  const TravelReport report = scale(scaled, constant(1.0));
  EXPECT_EQ(report.factor, 1.0);
  EXPECT_TRUE(is_same(walk, scaled));
  // Much slower than the first speed of the rule.
  const TravelReport slow = scale(scaled, {1.0, 0.85, 20.0, 30.0});
  EXPECT_EQ(slow.least, 1.0);
  EXPECT_TRUE(is_same(walk, scaled));
}

TEST(Travel, VaryingFactorKeepsFeetPlanted) {
  const Clip walk = accelerated(recorded_clip("walk"));
  Clip scaled = walk;
  const TravelReport report = scale(scaled, {1.0, 0.8, 0.6, 1.2});
  EXPECT_GT(report.greatest, 0.98);
  EXPECT_LT(report.least, 0.82);
  EXPECT_GT(report.factor, report.least);
  EXPECT_LT(report.factor, report.greatest);
  const HumanClip before = lafan1_human(walk), after = lafan1_human(scaled);
  EXPECT_LT(largest_slide(before, after), 2e-3);
  // The beginning is slow, the middle is fast; at the end the body stops.
  const auto ratio = [&](double from, double to) {
    const int last = walk.frame_count() - 1;
    const auto stretch = [&](const HumanClip& human) {
      return (way(human, int(to * last), Bone::kHips) - way(human, int(from * last), Bone::kHips))
          .norm();
    };
    return stretch(after) / stretch(before);
  };
  EXPECT_GT(ratio(0.0, 0.2), 0.97);
  EXPECT_LT(ratio(0.6, 0.8), 0.83);
}

TEST(Travel, FactorIsOneWhereHandsAndKneesRestOnTheFloor) {
  const Clip clip = recorded_clip("get_up");
  const ContactPlan contacts = find_contacts(lafan1_human(clip));
  Clip scaled = clip;
  const TravelReport report = scale(scaled, constant(0.7));
  EXPECT_EQ(report.greatest, 1.0);
  const HumanClip before = lafan1_human(clip), after = lafan1_human(scaled);
  int phases = 0;
  for (std::size_t body = 0; body < contacts.bodies.size(); ++body) {
    const Bone bone = kSupportBones[body];
    for (const ContactPhase& phase : contacts.bodies[body]) {
      ++phases;
      const Vector3d first = place(after, phase.begin, bone) - place(before, phase.begin, bone);
      const int last = phase.end - 1;
      EXPECT_LT((place(after, last, bone) - place(before, last, bone) - first).norm(), 2e-3)
          << bone_name(bone);
    }
  }
  EXPECT_GT(phases, 0);
}

TEST(Travel, ExcerptEqualsThatPartOfTheWholeMotion) {
  const Clip walk = recorded_clip("walk");
  const Calibration calibration = lafan1_calibration(walk.skeleton());
  Clip whole = walk, part = walk;
  scale_travel(whole, 0, {0, walk.frame_count()}, calibration, constant(0.9));
  scale_travel(part, 0, {100, 200}, calibration, constant(0.9));
  const HumanClip before = lafan1_human(walk), in_whole = lafan1_human(whole),
                  in_part = lafan1_human(part);
  // The first frame of the part does not change.
  EXPECT_LT((place(in_part, 100, Bone::kHips) - place(before, 100, Bone::kHips)).norm(), 1e-9);
  const Vector3d off = place(in_whole, 100, Bone::kHips) - place(in_part, 100, Bone::kHips);
  for (int frame = 100; frame < 200; ++frame) {
    for (const Bone bone : {Bone::kHips, Bone::kLeftFoot, Bone::kRightToe}) {
      EXPECT_LT((place(in_whole, frame, bone) - place(in_part, frame, bone) - off).norm(), 1e-8);
    }
  }
}

TEST(Travel, DoesNotChangeFramesBeforeTheMotion) {
  Clip walk = recorded_clip("walk");
  const Calibration calibration = lafan1_calibration(walk.skeleton());
  Clip scaled = walk;
  scale_travel(scaled, 50, {50, walk.frame_count()}, calibration, constant(0.9));
  for (int frame = 0; frame < 50; ++frame) {
    EXPECT_TRUE(std::ranges::equal(walk.translations(frame), scaled.translations(frame)));
  }
}

TEST(Travel, RuleChangesSmoothlyBetweenItsSpeeds) {
  const TravelRule rule{1.0, 0.85, 0.7, 1.5};
  EXPECT_EQ(rule.factor(0.0), 1.0);
  EXPECT_EQ(rule.factor(0.7), 1.0);
  EXPECT_DOUBLE_EQ(rule.factor(1.1), 0.925);
  EXPECT_DOUBLE_EQ(rule.factor(1.5), 0.85);
  EXPECT_DOUBLE_EQ(rule.factor(9.0), 0.85);
}

}  // namespace
}  // namespace retarget
