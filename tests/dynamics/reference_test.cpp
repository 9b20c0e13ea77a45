// References for controllers: samples, derivatives, limits, contacts, text.

#include "retarget/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/math/gravity.h"
#include "dynamics/references.h"
#include "retarget/so3.h"
#include "robot/shipped_robots.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

TEST(Reference, SamplesAreAtTheRequestedTimes) {
  const RobotClip clip = reference_sway(load_shipped("unitree_g1"), 31);
  for (const auto& [rate, count] : std::vector<std::pair<double, std::size_t>>{
           {50.0, 51}, {200.0, 201}, {500.0, 501}, {10.0, 11}, {1000.0, 1001}, {33.3, 34}}) {
    const MotionReference reference = reference_of(clip, rate);
    ASSERT_EQ(reference.samples, count) << rate;
    EXPECT_NEAR(reference.time.back(), static_cast<double>(count - 1) / rate, 1e-9);
    EXPECT_EQ(reference.qpos.size(), count * 36);
    EXPECT_EQ(reference.qvel.size(), count * 35);
    EXPECT_EQ(reference.torque.size(), count * 29);
  }
  // Samples at frame times equal the frames.
  const MotionReference at_frames = reference_of(clip, 30.0);
  ASSERT_EQ(at_frames.samples, 31U);
  for (int t = 0; t < 31; ++t) {
    const auto row = row_of(at_frames.qpos, 31, static_cast<std::size_t>(t));
    for (std::size_t k = 0; k < row.size(); ++k) EXPECT_NEAR(row[k], clip.qpos(t)[k], 1e-12);
  }
}

// 990 samples per second have 33 samples between two frames, so a fourth-order difference can stay
// within one piece of the spline: there it has no error for cubics and hardly any for the rotation.
TEST(Reference, VelocitiesAndAccelerationsAreDerivatives) {
  const MotionReference reference =
      reference_of(reference_sway(load_shipped("unitree_g1"), 40), 990.0);
  const std::size_t rows = reference.samples;
  const double h = 1.0 / 990.0;
  const auto difference = [&](const std::vector<double>& of, std::size_t i, std::size_t k) {
    const auto at = [&](std::size_t row) { return row_of(of, rows, row)[k]; };
    return (8.0 * (at(i + 1) - at(i - 1)) - at(i + 2) + at(i - 2)) / (12.0 * h);
  };
  const auto turn = [&](std::size_t from, std::size_t to) {
    return log_so3(rotation_of(row_of(reference.qpos, rows, from)).conjugate() *
                   rotation_of(row_of(reference.qpos, rows, to)));
  };
  double scale = 0.0;
  for (const double each : reference.qacc) scale = std::max(scale, std::abs(each));
  EXPECT_GT(scale, 0.5);
  int compared = 0;
  for (std::size_t i = 2; i + 2 < rows; ++i) {
    if (i % 33 < 2 || i % 33 > 31) continue;
    ++compared;
    const auto v = row_of(reference.qvel, rows, i), a = row_of(reference.qacc, rows, i);
    for (std::size_t k = 0; k < v.size(); ++k) {
      EXPECT_NEAR(difference(reference.qvel, i, k), a[k], 1e-8 * scale);
      if (k >= 3 && k < 6) continue;
      EXPECT_NEAR(difference(reference.qpos, i, k < 3 ? k : k + 1), v[k], 1e-9);
    }
    // In the axes of the body: log(R(-h)^-1 R(h)) / 2h, extrapolated from two steps.
    const Vector3d near = (turn(i, i + 1) - turn(i, i - 1)) / (2.0 * h);
    const Vector3d far = (turn(i, i + 2) - turn(i, i - 2)) / (4.0 * h);
    EXPECT_LT(((4.0 * near - far) / 3.0 - three_of(v, 3)).norm(), 1e-9);
  }
  EXPECT_GT(compared, 1000);
}

TEST(Reference, LimitsHoldBetweenFrames) {
  const auto robot = load_shipped("unitree_g1");
  const auto limits = value_of(load_limits(*robot, robot->limits_for({})));
  const int knee = *robot->find_joint("left_knee_joint");
  const int shoulder = *robot->find_joint("left_shoulder_pitch_joint");
  const auto address = [&](int joint) {
    return static_cast<std::size_t>(robot->joints()[static_cast<std::size_t>(joint)].qpos_address);
  };
  const double top = limits.upper[static_cast<std::size_t>(knee)];
  const double step = robot->speed_limit(shoulder) / 30.0;
  RobotClip clip = reference_stand(robot, 60);
  for (int t = 0; t < 60; ++t) {
    clip.qpos(t)[2] += 1.0;
    // The knee reaches its limit at once and stays there.
    clip.qpos(t)[address(knee)] = t < 20 ? top - 0.3 : top;
    // The shoulder swings at its speed limit.
    const int phase = t % 4 < 2 ? t % 4 : 4 - t % 4;
    clip.qpos(t)[address(shoulder)] = step * 0.999 * (phase - 1);
  }
  for (const double rate : {50.0, 1000.0}) {
    const MotionReference reference = reference_of(clip, rate);
    const auto column = [&](const char* name) {
      return static_cast<std::size_t>(std::ranges::find(reference.joint_names, name) -
                                      reference.joint_names.begin());
    };
    const std::size_t k = column("left_knee_joint"), e = column("left_shoulder_pitch_joint");
    double highest = -10.0, fastest = 0.0;
    for (std::size_t i = 0; i < reference.samples; ++i) {
      highest = std::max(highest, reference.qpos[36 * i + 7 + k]);
      fastest = std::max(fastest, std::abs(reference.qvel[35 * i + 6 + e]));
    }
    EXPECT_LE(highest, top);
    EXPECT_GT(highest, top - 0.01);
    EXPECT_LE(fastest, robot->speed_limit(shoulder));
    ASSERT_EQ(reference.corrections.size(), 2U);
    for (const ReferenceLimit& beyond : reference.beyond) {
      EXPECT_EQ(beyond.kind, ReferenceLimit::Kind::kTorque) << beyond.joint;
    }
  }
  // A frame beyond a limit is reported.
  clip.qpos(40)[address(knee)] = top + 0.05;
  const MotionReference reported = reference_of(clip, 200.0);
  const auto found = std::ranges::find_if(reported.beyond, [](const ReferenceLimit& beyond) {
    return beyond.kind == ReferenceLimit::Kind::kPosition;
  });
  ASSERT_NE(found, reported.beyond.end());
  EXPECT_EQ(found->joint, "left_knee_joint");
  EXPECT_NEAR(found->time, 40.0 / 30.0, 1e-6);
  EXPECT_NEAR(found->value, top + 0.05, 5e-3);
  EXPECT_EQ(found->limit, top);
}

TEST(Reference, ContactsDependLittleOnTheRate) {
  const RobotClip clip = reference_sway(load_shipped("unitree_g1"), 40);
  const MotionReference coarse = reference_of(clip, 25.0), fine = reference_of(clip, 250.0);
  const std::size_t points = coarse.contact_names.size();
  int differ = 0;
  for (std::size_t i = 0; i < coarse.samples; ++i) {
    for (std::size_t p = 0; p < points; ++p) {
      const auto same = std::ranges::find(fine.contact_names, coarse.contact_names[p]);
      ASSERT_NE(same, fine.contact_names.end());
      const auto column = static_cast<std::size_t>(same - fine.contact_names.begin());
      differ += coarse.contacts[points * i + p] !=
                fine.contacts[fine.contact_names.size() * 10 * i + column];
    }
  }
  EXPECT_LE(differ, static_cast<int>(coarse.samples * points / 20));
}

TEST(Reference, RejectsWrongRatesAndEmptyMotions) {
  const auto robot = load_shipped("unitree_g1");
  ReferenceOptions options;
  for (const FrameRate& rate : {FrameRate{9, 1}, FrameRate{1001, 1}}) {
    options.rate = rate;
    const auto made = make_reference(reference_stand(robot, 5), options);
    ASSERT_FALSE(made.has_value());
    EXPECT_EQ(made.error().kind, ErrorKind::kUsage);
  }
  options.rate = {200, 1};
  EXPECT_FALSE(make_reference(RobotClip(robot, {30, 1}, 0), options).has_value());
  for (const int frames : {1, 2, 3}) {
    const auto made = value_of(make_reference(reference_stand(robot, frames), options));
    EXPECT_EQ(made.samples, static_cast<std::size_t>(20 * (frames - 1) / 3 + 1));
  }
  options.max_bytes = 1000;
  const auto large = make_reference(reference_stand(robot, 30), options);
  ASSERT_FALSE(large.has_value());
  EXPECT_EQ(large.error().kind, ErrorKind::kInput);
}

TEST(Reference, TextColumnsMatchTheArrays) {
  const MotionReference reference =
      reference_of(reference_sway(load_shipped("unitree_g1"), 10), 50.0);
  const std::string text = format_reference_csv(reference);
  const std::vector<std::string> columns = reference_columns(reference);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), reference.samples + 1);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text.substr(0, text.find('\n')), ',')),
            columns.size() - 1);
  EXPECT_EQ(columns.size(), 1 + 36 + 35 + 35 + 29 + 6 + 12 + 7 * reference.contact_names.size());
  EXPECT_EQ(columns.front(), "time");
  EXPECT_TRUE(format_reference_npz(reference).has_value());
}

}  // namespace
}  // namespace retarget
