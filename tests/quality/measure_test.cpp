// Metrics in cases with a known solution.

#include "retarget/measure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "quality/walker.h"
#include "retarget/human_skeleton.h"
#include "retarget/report.h"

namespace retarget {
namespace {

using ::testing::IsEmpty;

TEST_F(MeasureQuality, StandingRobotHasNoFaults) {
  const HumanClip human = standing_human(30);
  const QualityReport report = measure(
      30, [](int, auto) {}, &human);
  for (const char* key : {"limit_pct",         "limit_max_rad",    "speed_limit_pct",
                          "peak_speed",        "fast_3pi_pct",     "jumps",
                          "jump_frames",       "acc_rms",          "acc_p99",
                          "root_jerk_mean",    "foot_pen_1cm_pct", "body_pen_1cm_pct",
                          "float_2cm_pct",     "flat_slip_p50",    "self_1cm_pct",
                          "self_max_cm",       "self_all_1cm_pct", "float_planted_pct",
                          "contact_slip_mean", "contact_slip_p95", "contact_drift_p95_cm"}) {
    EXPECT_EQ(figure(report, key), 0.0) << key;
  }
  EXPECT_NEAR(figure(report, "foot_pen_max_cm"), 0.0, 1e-12);
  EXPECT_NEAR(figure(report, "contact_height_p50_cm"), 0.0, 1e-12);
  EXPECT_EQ(figure(report, "contact_pct"), 100.0);
  EXPECT_EQ(figure(report, "contact_agreement_pct"), 100.0);
  EXPECT_EQ(figure(report, "contact_kept_pct"), 100.0);
  EXPECT_THAT(report.faults, IsEmpty());
}

// Skates: no foot ever stands.
TEST_F(MeasureQuality, NoticesLostStances) {
  const auto measure_human = [&](double metres_per_second, int frames, bool up_is_uncertain) {
    HumanClip human = standing_human(frames);
    for (int frame = 0; frame < frames; ++frame) {
      for (const Bone bone : kAllBones) {
        Pose& pose = human.world_from_bone[static_cast<std::size_t>(frame)][bone];
        pose.rotation = canonical_t_pose(bone);
        pose.translation.x() += metres_per_second * frame / 30.0;
      }
    }
    QualitySource source{.human = &human};
    source.up_is_uncertain = up_is_uncertain;
    return measure_quality(make(frames, [](int, auto) {}), robot_->model_limits(), &source);
  };
  EXPECT_FALSE(measure_human(0.0, 90, false).lost_stances);
  EXPECT_FALSE(measure_human(0.0, 90, true).lost_stances);
  EXPECT_TRUE(measure_human(1.0, 90, false).lost_stances);
  // Too short to judge, unless the body may not lie.
  EXPECT_FALSE(measure_human(1.0, 45, false).lost_stances);
  EXPECT_TRUE(measure_human(1.0, 45, true).lost_stances);
}

// A rigidly dropped robot: root and centre of mass fall alike.
TEST_F(MeasureQuality, MeasuresBodyAccelerations) {
  const QualityReport falling = measure(31, [](int frame, auto qpos) {
    const double time = frame / 30.0;
    qpos[kX] += 2.0 * time;
    qpos[kZ] -= 0.5 * 9.81 * time * time;
  });
  EXPECT_NEAR(figure(falling, "root_acc_p99"), 9.81, 1e-8);
  EXPECT_NEAR(figure(falling, "com_acc_p99"), 9.81, 1e-8);
  EXPECT_NEAR(figure(falling, "com_acc_rms"), 9.81, 1e-8);
}

TEST_F(MeasureQuality, MeasuresSlipOfASlidingFoot) {
  const HumanClip human = standing_human(31);
  const QualityReport report = measure(
      31, [](int frame, auto qpos) { qpos[kX] = 0.1 * frame / 30.0; }, &human);
  for (const char* key : {"contact_slip_mean", "contact_slip_p95", "flat_slip_p50"}) {
    EXPECT_NEAR(figure(report, key), 0.1, 1e-12) << key;
  }
  // 10 cm per second, half of it to each side of the middle.
  EXPECT_NEAR(figure(report, "contact_drift_p95_cm"), 5.0, 1e-9);
  EXPECT_EQ(figure(report, "contact_agreement_pct"), 100.0);
}

// Rotates the feet of a human from the T-pose.
void turn_feet(HumanClip& human, double angle) {
  for (const char* name : {"LeftFoot", "RightFoot"}) {
    const Bone bone = bone_from_name(name).value();
    for (int i = 0; i < human.frame_count; ++i) {
      human.world_from_bone[static_cast<std::size_t>(i)][bone].rotation =
          Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
          Eigen::Quaterniond(canonical_t_pose(bone));
    }
  }
}

TEST_F(MeasureQuality, StanceRequiresTheFootOnItsSole) {
  HumanClip human = standing_human(30);
  const auto slide_in_the_air = [](int frame, auto qpos) {
    qpos[kX] = 0.1 * frame / 30.0;
    qpos[kZ] = 0.51;
  };
  turn_feet(human, 0.0);
  const QualityReport standing = measure(30, slide_in_the_air, &human);
  EXPECT_EQ(figure(standing, "stance_pct"), 100.0);
  EXPECT_NEAR(figure(standing, "stance_slip_mean"), 0.1, 1e-12);
  EXPECT_NEAR(figure(standing, "stance_height_p50_cm"), 1.0, 1e-9);
  EXPECT_EQ(figure(standing, "stance_drift_p95_cm"), figure(standing, "contact_drift_p95_cm"));
  // A foot on its instep, with its joints at the height of a planted foot's: the body crawls.
  turn_feet(human, 2.0);
  const QualityReport lying = measure(30, slide_in_the_air, &human);
  EXPECT_EQ(figure(lying, "contact_pct"), 100.0);
  for (const char* key :
       {"stance_pct", "stance_slip_mean", "stance_drift_p95_cm", "stance_height_p50_cm"}) {
    EXPECT_EQ(lying.find(key), nullptr) << key;
  }
}

TEST_F(MeasureQuality, HoveringFootFloats) {
  const HumanClip human = standing_human(30);
  const QualityReport report = measure(
      30, [](int frame, auto qpos) { qpos[kZ] = frame < 6 ? 0.53 : 0.5; }, &human);
  EXPECT_DOUBLE_EQ(figure(report, "float_planted_pct"), 20.0);
  EXPECT_DOUBLE_EQ(figure(report, "float_2cm_pct"), 20.0);
  EXPECT_DOUBLE_EQ(figure(report, "contact_kept_pct"), 80.0 - 100.0 / 30.0);  // and the landing
  const auto faults = faults_of(report, "float_planted_pct");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].begin, 0);
  EXPECT_EQ(faults[0].end, 6);
  EXPECT_NEAR(faults[0].amount, 0.03, 1e-12);
}

TEST_F(MeasureQuality, HoversWhereTheSourceIsLower) {
  HumanClip human = standing_human(30);
  const auto raised = [](int frame, auto qpos) { qpos[kZ] = frame < 6 ? 0.53 : 0.5; };
  const QualityReport report = measure(30, raised, &human);
  EXPECT_DOUBLE_EQ(figure(report, "hover_pct"), 20.0);
  const auto faults = faults_of(report, "hover_pct");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].end, 6);
  EXPECT_NEAR(faults[0].amount, 0.03, 1e-12);
  // The source's feet are as high, on tiptoe or on a step.
  for (int frame = 0; frame < 6; ++frame) {
    for (const Bone bone : kAllBones) {
      human.world_from_bone[static_cast<std::size_t>(frame)][bone].translation.z() += 0.03;
    }
  }
  EXPECT_EQ(figure(measure(30, raised, &human), "hover_pct"), 0.0);
}

TEST_F(MeasureQuality, HoversWithoutPlannedContacts) {
  HumanClip human = standing_human(30);
  for (int frame = 0; frame < 30; ++frame) {
    for (const Bone bone : kAllBones) {
      human.world_from_bone[static_cast<std::size_t>(frame)][bone].translation.x() += 0.1 * frame;
    }
  }
  const auto glide = [](double height) {
    return [height](int frame, auto qpos) {
      qpos[kX] = 0.1 * frame;
      qpos[kZ] = height;
    };
  };
  const QualityReport hovering = measure(30, glide(0.8), &human);
  EXPECT_EQ(hovering.find("contact_pct"), nullptr);
  EXPECT_EQ(figure(hovering, "float_planted_pct"), 0.0);
  EXPECT_EQ(figure(hovering, "hover_pct"), 100.0);
  EXPECT_EQ(figure(measure(30, glide(0.5), &human), "hover_pct"), 0.0);
}

TEST_F(MeasureQuality, MeasuresFloorPenetration) {
  // Soles 1.5 cm deep in frame 3 alone.
  const QualityReport deep =
      measure(10, [](int frame, auto qpos) { qpos[kZ] = frame == 3 ? 0.485 : 0.5; });
  EXPECT_DOUBLE_EQ(figure(deep, "foot_pen_1cm_pct"), 10.0);
  EXPECT_NEAR(figure(deep, "foot_pen_max_cm"), 1.5, 1e-9);
  EXPECT_DOUBLE_EQ(figure(deep, "body_pen_1cm_pct"), 10.0);
  // Upside down, the hand, a sphere of 10 cm, is the lowest: 30 cm below the base.
  const QualityReport turned = measure(10, [](int frame, auto qpos) {
    qpos[3] = 0.0;
    qpos[4] = 1.0;
    qpos[kZ] = frame < 5 ? 0.288 : 0.292;
  });
  EXPECT_DOUBLE_EQ(figure(turned, "foot_pen_1cm_pct"), 0.0);
  EXPECT_DOUBLE_EQ(figure(turned, "body_pen_1cm_pct"), 50.0);
  EXPECT_NEAR(figure(turned, "body_pen_max_cm"), 1.2, 1e-9);
}

TEST_F(MeasureQuality, MeasuresStepsSpeedsAndLimits) {
  // The right joint moves 0.6 rad in one step and back in the next.
  const QualityReport report =
      measure(11, [](int frame, auto qpos) { qpos[kRight] = frame == 5 ? 0.6 : 0.0; });
  EXPECT_EQ(figure(report, "jumps"), 2.0);
  EXPECT_EQ(figure(report, "jump_frames"), 2.0);
  EXPECT_DOUBLE_EQ(figure(report, "max_step_rad"), 0.6);
  EXPECT_DOUBLE_EQ(figure(report, "peak_speed"), 18.0);
  EXPECT_DOUBLE_EQ(figure(report, "fast_3pi_pct"), 20.0);
  EXPECT_DOUBLE_EQ(figure(report, "speed_limit_pct"), 20.0);
  EXPECT_DOUBLE_EQ(figure(report, "speed_limit_max_ratio"), 4.5);
  // Second differences 0.6, -1.2, 0.6 of nine in four joints.
  EXPECT_NEAR(figure(report, "acc_rms"), 900.0 * std::sqrt(2.16 / 36.0), 1e-9);
  EXPECT_EQ(report.speed_limits_given, 1);
  EXPECT_EQ(report.speed_limits_assumed, 3);
  const auto faults = faults_of(report, "jumps");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].where, "right");
  EXPECT_EQ(faults[0].begin, 4);
  EXPECT_EQ(faults[0].end, 6);
}

TEST_F(MeasureQuality, SpeedsArePerSecondAtEveryRate) {
  RobotClip clip(robot_, {120, 1}, 121);
  for (int frame = 0; frame <= 120; ++frame) clip.qpos(frame)[kLeft] = 10.0 * frame / 120.0 - 5.0;
  const QualityReport report = measure_quality(clip, robot_->model_limits());
  EXPECT_NEAR(figure(report, "peak_speed"), 10.0, 1e-9);
  EXPECT_DOUBLE_EQ(figure(report, "fast_3pi_pct"), 100.0);
  EXPECT_DOUBLE_EQ(figure(report, "speed_limit_pct"), 0.0);
}

TEST_F(MeasureQuality, ReportsEveryLimitSet) {
  const QualityReport report = measure(10, [](int frame, auto qpos) {
    qpos[kLeft] = frame < 4 ? 0.5 : 0.1 + 5e-7;
    qpos[kRight] = frame == 9 ? -1.25 : 0.0;
  });
  EXPECT_DOUBLE_EQ(figure(report, "limit_pct"), 10.0);
  EXPECT_DOUBLE_EQ(figure(report, "limit_max_rad"), 0.25);
  ASSERT_EQ(report.limit_sets.size(), 2u);
  EXPECT_EQ(report.limit_sets[0].name, "model");
  EXPECT_EQ(report.limit_sets[1].name, "narrow");
  EXPECT_DOUBLE_EQ(report.limit_sets[1].frames_pct, 50.0);
  EXPECT_EQ(report.limit_sets[1].joint, "left");
  EXPECT_DOUBLE_EQ(report.limit_sets[1].worst_excess, 0.4);
}

TEST_F(MeasureQuality, MeasuresSelfCollision) {
  // The hand's sphere comes within 18 cm of the knob's: 2 cm deep, in frames 4 and 5.
  const QualityReport report =
      measure(10, [](int frame, auto qpos) { qpos[kArm] = frame == 4 || frame == 5 ? 0.12 : 0.0; });
  EXPECT_DOUBLE_EQ(figure(report, "self_all_1cm_pct"), 20.0);
  EXPECT_NEAR(figure(report, "self_all_max_cm"), 2.0, 1e-9);
  // Of frames 0 and 5.
  EXPECT_DOUBLE_EQ(figure(report, "self_1cm_pct"), 50.0);
  EXPECT_NEAR(figure(report, "self_max_cm"), 2.0, 1e-9);
  const auto faults = faults_of(report, "self_all_1cm_pct");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].where, "hand in knob");
}

TEST_F(MeasureQuality, MeasuresBodiesThatPassThroughEachOther) {
  // The hand passes through the knob between frames 4 and 5, 30 cm to either side of it.
  const auto pass = [](int frame, auto qpos) { qpos[kArm] = frame < 5 ? 0.0 : 0.6; };
  const QualityReport report = measure(10, pass);
  EXPECT_EQ(figure(report, "self_all_max_cm"), 0.0);
  EXPECT_NEAR(figure(report, "self_crossing_max_cm"), 20.0, 1e-9);
  const auto faults = faults_of(report, "self_crossing_max_cm");
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].where, "hand in knob");
  EXPECT_EQ(faults[0].begin, 4);
  // The whole body moves as far.
  const auto move = [](int frame, auto qpos) { qpos[kX] = frame < 5 ? 0.0 : 0.6; };
  EXPECT_EQ(figure(measure(10, move), "self_crossing_max_cm"), 0.0);
  // Frames that are 5 cm apart show the overlap themselves.
  const auto slow = [](int frame, auto qpos) { qpos[kArm] = 0.05 * frame; };
  EXPECT_EQ(figure(measure(10, slow), "self_crossing_max_cm"), 0.0);
}

TEST_F(MeasureQuality, CountsRootJumps) {
  // A step of 0.3 m at 30 fps is 9 m/s, one of 0.4 m is 12.
  EXPECT_EQ(figure(measure(20, [](int frame, auto qpos) { qpos[kX] = frame < 10 ? 0.0 : 0.3; }),
                   "root_jumps"),
            0.0);
  EXPECT_EQ(figure(measure(20, [](int frame, auto qpos) { qpos[kX] = frame < 10 ? 0.0 : 0.4; }),
                   "root_jumps"),
            1.0);
  const auto moved = faults_of(
      measure(20, [](int frame, auto qpos) { qpos[kX] = frame < 10 ? 0.0 : 1.5; }), "root_jumps");
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_NEAR(moved[0].amount, 45.0, 1e-9);
  EXPECT_EQ(moved[0].unit, "m/s");
  // Rotated about the vertical, with the opposite quaternion.
  const auto turned_by = [this](double angle) {
    return measure(20, [angle](int frame, auto qpos) {
      if (frame < 10) return;
      qpos[3] = -std::cos(0.5 * angle);
      qpos[6] = -std::sin(0.5 * angle);
    });
  };
  EXPECT_EQ(figure(turned_by(0.6), "root_jumps"), 0.0);
  EXPECT_EQ(figure(turned_by(0.7), "root_jumps"), 1.0);
  const auto faults = faults_of(turned_by(M_PI), "root_jumps");
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].begin, 9);
  EXPECT_NEAR(faults[0].amount, 30.0 * M_PI, 1e-9);
}

TEST_F(MeasureQuality, MeasuresRootJerk) {
  // x = t^3 has the jerk 6.
  const QualityReport report =
      measure(20, [](int frame, auto qpos) { qpos[kX] = std::pow(frame / 30.0, 3); });
  EXPECT_NEAR(figure(report, "root_jerk_mean"), 6.0, 1e-9);
  EXPECT_NEAR(figure(report, "root_jerk_p99"), 6.0, 1e-9);
}

// At 1,000 frames per second, the rounding of files would dominate the differences of consecutive
// positions: 2,000 m/s^3 and 0.6 mm/s.
TEST_F(MeasureQuality, RoundingHardlyChangesJerkAndSlipAtHighRates) {
  constexpr int kFrames = 2000;
  const auto report_of = [&](double unit) {
    RobotClip clip(robot_, {1000, 1}, kFrames);
    for (int frame = 0; frame < kFrames; ++frame) {
      const double time = frame / 1000.0;
      clip.qpos(frame)[kZ] = 0.5;
      clip.qpos(frame)[kX] = std::round(0.01 * std::sin(1.7 * time) / unit) * unit;
    }
    const HumanClip human = standing_human(kFrames);
    const QualitySource source{&human};
    return measure_quality(clip, robot_->model_limits(), &source);
  };
  const QualityReport exact = report_of(1e-12), rounded = report_of(1e-6);
  EXPECT_NEAR(figure(exact, "root_jerk_mean"), 0.04, 0.01);
  EXPECT_NEAR(figure(rounded, "root_jerk_mean"), figure(exact, "root_jerk_mean"), 4.0);
  EXPECT_NEAR(figure(rounded, "contact_slip_mean"), figure(exact, "contact_slip_mean"), 1e-5);
}

TEST_F(MeasureQuality, ListsAFewFaultsWorstFirst) {
  // 20 one-frame ranges, ever farther beyond the limit of 1.
  const QualityReport report = measure(40, [](int frame, auto qpos) {
    qpos[kRight] = frame % 2 == 1 ? 1.0 + 0.001 * (frame + 1) : 0.0;
    qpos[kKnob] = 0.0;
  });
  const auto faults = faults_of(report, "limit_pct");
  ASSERT_EQ(faults.size(), QualityOptions{}.faults_per_metric);
  EXPECT_EQ(faults[0].worst_frame, 39);
  EXPECT_NEAR(faults[0].amount, 0.04, 1e-12);
  EXPECT_EQ(faults[1].worst_frame, 37);
  // The text states their number.
  const auto total = std::ranges::find(report.fault_totals, "limit_pct", &FaultTotal::metric);
  ASSERT_NE(total, report.fault_totals.end());
  EXPECT_EQ(total->count, 20);
}

TEST_F(MeasureQuality, HandlesVeryShortMotions) {
  for (const int frames : {1, 2, 3}) {
    const HumanClip human = standing_human(frames);
    const QualityReport report = measure(
        frames, [](int, auto) {}, &human);
    EXPECT_EQ(report.frames, frames);
    EXPECT_EQ(figure(report, "limit_pct"), 0.0);
    EXPECT_EQ(figure(report, "float_planted_pct"), 0.0);
    EXPECT_EQ(report.find("jumps") != nullptr, frames > 1);
    EXPECT_EQ(report.find("acc_p99") != nullptr, frames > 2);
    EXPECT_EQ(report.find("contact_slip_mean") != nullptr, frames > 2);
    EXPECT_FALSE(report_json({&report, 1}).empty());
  }
}

TEST_F(MeasureQuality, HandlesShorterOrLongerSources) {
  for (const int frames : {12, 40}) {
    const HumanClip human = standing_human(frames);
    const QualityReport report = measure(
        24, [](int, auto) {}, &human);
    EXPECT_EQ(report.source_frames, std::min(frames, 24));
    EXPECT_DOUBLE_EQ(figure(report, "contact_pct"), frames < 24 ? 50.0 : 100.0);
  }
}

TEST_F(MeasureQuality, MeasuresWhetherTheSourceRestsOnItsFeet) {
  const auto speed_of = [&](const HumanClip& human) {
    return measure(
               30, [](int, auto) {}, &human)
        .find("source_slide_mean")
        ->value;
  };
  HumanClip human = standing_human(30);
  EXPECT_EQ(speed_of(human), 0.0);
  // Both feet walk in place at 0.6 m/s: none rests.
  for (int frame = 0; frame < 30; ++frame) {
    for (const Side side : kSides) {
      const double away = (side == Side::kLeft ? 0.02 : -0.02) * frame;
      for (const LimbBone part : {LimbBone::kFoot, LimbBone::kToe}) {
        human.world_from_bone[static_cast<std::size_t>(frame)][side_bone(side, part)]
            .translation.x() += away;
      }
    }
  }
  EXPECT_NEAR(speed_of(human), 0.6, 1e-9);
  // If the hips are as fast, the feet may be in the air.
  HumanClip flying = human;
  for (int frame = 0; frame < 30; ++frame) {
    HumanPose& pose = flying.world_from_bone[static_cast<std::size_t>(frame)];
    for (const Bone hip : {Bone::kLeftUpLeg, Bone::kRightUpLeg}) {
      pose[hip].translation.x() += 0.02 * frame;
    }
  }
  EXPECT_NEAR(speed_of(flying), 0.0, 1e-9);
  // One resting foot suffices.
  for (int frame = 0; frame < 30; ++frame) {
    human.world_from_bone[static_cast<std::size_t>(frame)][Bone::kLeftToe].translation.x() = 0.1;
  }
  EXPECT_NEAR(speed_of(human), 0.0, 1e-9);
}

}  // namespace
}  // namespace retarget
