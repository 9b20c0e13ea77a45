// Moves of whole bodies over the ground, the floor, cycles.

#include <gmock/gmock.h>

#include "base/option_name.h"
#include "edit/fit_path.h"
#include "edit/ground_pose.h"
#include "edit_sample.h"
#include "human/gait/contact_plan.h"
#include "retarget/edit.h"
#include "support/angles.h"

namespace retarget {
namespace {

using namespace edit_test;

Clip moved(const EditSample& sample, const GroundPose& move) {
  Clip clip = sample.clip;
  BodyMover::of(clip, sample.calibration).value().move_all(clip, move.in_space());
  return clip;
}

TEST(GroundPoses, FormAGroup) {
  const GroundPose a{{1.0, -2.0}, 0.7}, b{{0.3, 4.0}, -2.1};
  const Eigen::Vector2d point(0.2, -0.9);
  EXPECT_LT(((a * b) * point - a * (b * point)).norm(), 1e-14);
  EXPECT_LT(((a.inverse() * a) * point - point).norm(), 1e-14);
  EXPECT_LT(
      (turn_about({3.0, 1.0}, 1.0) * Eigen::Vector2d(3.0, 1.0) - Eigen::Vector2d(3.0, 1.0)).norm(),
      1e-14);
}

TEST(BodyMoves, AreRigidAndChangeOnlyTheRoot) {
  const EditSample& sample = data_sample("walk");
  const GroundPose move{{1.5, -0.5}, 0.8};
  const Clip clip = moved(sample, move);
  const HumanClip before = sample.human(), after = sample.human_of(clip);
  const auto places = hips_over_ground(before), new_places = hips_over_ground(after);
  for (int frame = 0; frame < clip.frame_count(); frame += 20) {
    for (const Bone bone : kMappedBones) {
      ASSERT_LT((move.in_space() * before.frame(frame)[bone].translation -
                 after.frame(frame)[bone].translation)
                    .norm(),
                1e-9);
    }
    EXPECT_NEAR(new_places[frame].heading - places[frame].heading, 0.8, 1e-9);
    for (int joint = 1; joint < clip.skeleton().joint_count(); ++joint) {
      ASSERT_EQ(clip.rotations(frame)[joint].coeffs(),
                sample.clip.rotations(frame)[joint].coeffs());
    }
  }
  EXPECT_LT(largest_distance(through_bvh(clip), clip, 0.01), 1e-7);
}

TEST(BodyMoves, HeadingIsContinuousOverFullTurns) {
  const EditSample& sample = data_sample("turn_in_place");
  const auto places = hips_over_ground(sample.human());
  for (std::size_t i = 1; i < places.size(); ++i) {
    ASSERT_LT(std::abs(places[i].heading - places[i - 1].heading), 0.5);
  }
}

TEST(BodyMoves, RequireAJointThatMovesTheBody) {
  const EditSample& sample = data_sample("walk");
  std::vector<Joint> joints = sample.clip.skeleton().joints();
  std::erase_if(joints[0].channels, is_position);
  const auto mover = BodyMover::of(
      Clip(std::make_shared<const Skeleton>(joints), sample.clip.rate(), 1), sample.calibration);
  ASSERT_FALSE(mover);
  EXPECT_EQ(mover.error().kind, ErrorKind::kInput);
  EXPECT_THAT(mover.error().message, testing::HasSubstr("no joint moves the whole body"));
}

TEST(Floor, IsAtThePlantedFeet) {
  const EditSample& sample = data_sample("walk");
  Clip raised = sample.clip;
  const auto mover = BodyMover::of(raised, sample.calibration).value();
  mover.move_all(raised, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.37}});
  const double floor = floor_height(sample.clip, sample.calibration).value();
  EXPECT_NEAR(floor_height(raised, sample.calibration).value(), floor + 0.37, 1e-9);
  const Clip grounded = put_on_floor(raised, sample.calibration, floor + 0.37).value();
  EXPECT_NEAR(floor_height(grounded, sample.calibration).value(), 0.0, 1e-9);
}

TEST(Floor, FlyingBodyIsAnError) {
  const EditSample& sample = data_sample("walk");
  Clip flying = cut(sample.clip, 0, 60);
  const auto mover = BodyMover::of(flying, sample.calibration).value();
  for (int i = 0; i < flying.frame_count(); ++i)
    mover.move(flying, i, {{}, {0.2 * i, 0.0, 0.1 * i}});
  const auto floor = floor_height(flying, sample.calibration);
  ASSERT_FALSE(floor);
  EXPECT_THAT(floor.error().hint, testing::HasSubstr(OPTION("floor")));
}

TEST(Floor, SingleFrameUsesTheLowerFoot) {
  const EditSample& sample = data_sample("walk");
  const double floor = floor_height(cut(sample.clip, 0, 1), sample.calibration).value();
  EXPECT_NEAR(floor, floor_height(sample.clip, sample.calibration).value(), 0.01);
}

// The walk has periodic strides from frame 100.
TEST(Loops, WalkLoopsWithoutASeam) {
  const EditSample& sample = data_sample("walk");
  const Clip strides = cut(sample.clip, 100, 220);
  LoopOptions options;
  options.shortest = 0.6;
  options.times = 3;
  const Loop loop = make_loop(strides, sample.calibration, options).value();
  EXPECT_LT(loop.distance, 0.02);
  EXPECT_EQ(loop.clip.frame_count(), 3 * loop.cycle);
  EXPECT_NEAR(loop.advance.position.norm(), 1.2 * loop.cycle / 30.0, 0.05);
  EXPECT_NEAR(loop.way.norm(), 1.2 * loop.cycle / 30.0, 0.05);
  // Accelerations at the seams equal those of the strides.
  const auto largest_acceleration = [&](const Clip& clip, int begin, int end) {
    const HumanClip human = sample.human_of(clip);
    double largest = 0.0;
    for (int frame = begin; frame < end; ++frame) {
      for (const Bone bone : kMappedBones) {
        const auto at = [&](int f) { return human.frame(f)[bone].translation; };
        largest =
            std::max(largest, (at(frame + 1) - 2.0 * at(frame) + at(frame - 1)).norm() * 900.0);
      }
    }
    return largest;
  };
  const double usual = largest_acceleration(strides, 1, 119);
  EXPECT_LT(largest_acceleration(loop.clip, loop.cycle - 4, loop.cycle + 4), 1.2 * usual);
}

// Beginning and end differ: feet stay planted, and the report says that the clip is not a cycle.
TEST(Loops, FeetStayPlantedAndBadSeamsAreReported) {
  const EditSample& sample = data_sample("walk");
  LoopOptions options;
  options.shortest = 2.4;
  options.times = 2;
  const Clip part = cut(sample.clip, 100, 181);
  const Loop loop = make_loop(part, sample.calibration, options).value();
  const HumanClip human = sample.human_of(loop.clip), source = sample.human_of(part);
  const ContactPlan contacts = find_contacts(source);
  int seen = 0;
  const double floor = floor_height(sample.clip, sample.calibration).value();
  EXPECT_NEAR(floor_height(loop.clip, sample.calibration).value(), floor, 0.01);
  for (int foot = 0; foot < 2; ++foot) {
    const Bone bone = *bone_from_name(foot == 0 ? "LeftFoot" : "RightFoot");
    for (const ContactPhase& phase : contacts.phases[foot]) {
      // The second cycle; contacts on both sides of the seam may differ.
      const int begin = std::max(phase.begin, 4), end = std::min(phase.end, loop.cycle - 4);
      if (begin >= end) continue;
      ++seen;
      const auto way = [&](const HumanClip& in, int first) {
        const Eigen::Vector3d from = in.frame(first + begin)[bone].translation;
        return (in.frame(first + end - 1)[bone].translation - from).head<2>().norm();
      };
      EXPECT_LT(way(human, loop.cycle), way(source, 0) + 0.01) << begin;
    }
  }
  EXPECT_GT(seen, 1);
  const EditSample& up = data_sample("get_up");
  const Loop bad = make_loop(up.clip, up.calibration, {}).value();
  EXPECT_GT(bad.distance, 0.2);
  EXPECT_FALSE(bad.check.faults.empty());
}

TEST(Loops, InPlaceReturnsToTheStart) {
  const EditSample& sample = data_sample("walk");
  LoopOptions options;
  options.shortest = 0.6;
  options.in_place = true;
  options.times = 2;
  const Loop loop = make_loop(cut(sample.clip, 100, 220), sample.calibration, options).value();
  EXPECT_LT(largest_distance(cut(loop.clip, 0, loop.cycle),
                             cut(loop.clip, loop.cycle, 2 * loop.cycle), 0.01),
            1e-12);
  for (const GroundPose& place : hips_over_ground(sample.human_of(loop.clip))) {
    EXPECT_LT((place.position - hips_over_ground(sample.human_of(loop.clip))[0].position).norm(),
              0.15);
  }
  ASSERT_EQ(loop.notes.size(), 3U);
  EXPECT_THAT(loop.notes[2].text, testing::HasSubstr("clean"));
}

// A walk once around a circle, almost or exactly.
TEST(Loops, InPlaceRemovesFullTurns) {
  const EditSample& sample = data_sample("walk");
  const Clip part = cut(sample.clip, 60, 220);
  LoopOptions options;
  options.shortest = 3.0;
  const Loop straight = make_loop(part, sample.calibration, options).value();
  const PathMotion own = fit_path(part, sample.calibration).value();
  options.shortest = straight.cycle / 30.0;
  options.in_place = true;
  for (const double degrees : {359.0, 360.0, 361.0}) {
    const double radius = straight.way.norm() / (degrees * kPi / 180.0);
    const GroundPath circle = circle_path(own.path.at(0.0), radius, own.path.length());
    const Clip walk = follow_path(part, sample.calibration, circle, {})->clip;
    const Loop loop = make_loop(walk, sample.calibration, options).value();
    ASSERT_NEAR(loop.advance.heading, 2.0 * kPi, 0.1);
    const auto hips = hips_over_ground(sample.human_of(loop.clip));
    for (const GroundPose& place : hips) {
      ASSERT_LT((place.position - hips.front().position).norm(), 0.2) << degrees;
    }
  }
}

// A walk that starts and stops is slower there than its mean speed, which is removed.
TEST(Loops, InPlaceReportsUnevenTravel) {
  const EditSample& sample = data_sample("walk");
  LoopOptions options;
  options.in_place = true;
  const Loop loop = make_loop(sample.clip, sample.calibration, options).value();
  ASSERT_EQ(loop.notes.size(), 4U);
  EXPECT_THAT(loop.notes[2].text, testing::HasSubstr("still move up to"));
  EXPECT_THAT(loop.notes[3].text, testing::HasSubstr("clean"));
  options.in_place = false;
  EXPECT_EQ(make_loop(sample.clip, sample.calibration, options)->notes.size(), 2U);
}

TEST(Loops, HandleShortAndStillClips) {
  const EditSample& sample = data_sample("walk");
  EXPECT_FALSE(make_loop(cut(sample.clip, 0, 1), sample.calibration, {}));
  EXPECT_FALSE(make_loop(cut(sample.clip, 0, 0), sample.calibration, {}));
  LoopOptions too_long;
  too_long.shortest = 100.0;
  EXPECT_FALSE(make_loop(sample.clip, sample.calibration, too_long));
  // A standing body keeps standing.
  Clip still = cut(sample.clip, 0, 30);
  for (int i = 0; i < 30; ++i) {
    std::ranges::copy(sample.clip.rotations(0), still.rotations(i).begin());
    std::ranges::copy(sample.clip.translations(0), still.translations(i).begin());
  }
  const Loop loop = make_loop(still, sample.calibration, {}).value();
  EXPECT_LT(largest_distance(loop.clip, cut(still, 0, loop.cycle), 0.01), 1e-12);
}

}  // namespace
}  // namespace retarget
