#include "retarget/motion_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "formats/robot_motion/raw_motion.h"
#include "retarget/compare.h"
#include "retarget/resample.h"
#include "retarget/so3.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr MotionFormat kAllFormats[] = {MotionFormat::kCsv,      MotionFormat::kCsvSoma,
                                        MotionFormat::kNpzMjlab, MotionFormat::kNpzBeyondMimic,
                                        MotionFormat::kPklGmr,   MotionFormat::kPklPbhc};

// Positions of the sole points.
std::vector<Eigen::Vector3d> sole_points(const RobotClip& clip, int frame) {
  const Robot& robot = clip.robot();
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, clip.qpos(frame), world_from_body);
  std::vector<Eigen::Vector3d> points;
  for (const Sole& sole : robot.profile().soles) {
    for (const auto& point : sole.points) points.push_back(world_from_body[sole.body] * point);
  }
  return points;
}

// Moves the root so that the lowest sole point of each frame keeps its position.
void stand_on_feet(RobotClip& clip) {
  for (int frame = 1; frame < clip.frame_count(); ++frame) {
    const auto before = sole_points(clip, frame - 1), now = sole_points(clip, frame);
    std::size_t lowest = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i].z() < before[lowest].z()) lowest = i;
    }
    for (int i = 0; i < 2; ++i) {
      clip.qpos(frame)[static_cast<std::size_t>(i)] += before[lowest][i] - now[lowest][i];
    }
  }
}

// A G1 that walks at this heading, with swinging legs and arms.
class RobotMotionTest : public ::testing::Test {
 protected:
  RobotClip walk(double heading, int frames = 40) const {
    RobotClip clip(robot_, {30, 1}, frames);
    for (int frame = 0; frame < frames; ++frame) {
      const double t = frame / 30.0;
      const auto qpos = clip.qpos(frame);
      const Eigen::Quaterniond turn =
          exp_so3({0.0, 0.0, heading}) * exp_so3({0.03 * std::sin(5 * t), 0.05, 0.0});
      qpos[0] = 0.3;
      qpos[2] = 0.76;
      qpos[3] = turn.w();
      for (int i = 0; i < 3; ++i) qpos[4 + i] = turn.vec()[i];
      for (std::size_t i = 7; i < qpos.size(); ++i) {
        qpos[i] = 0.2 + 0.3 * std::sin(6 * t + static_cast<double>(i));
      }
    }
    stand_on_feet(clip);
    return clip;
  }
  Result<RobotMotion> read(const std::string& bytes, const ReadMotionOptions& options = {}) const {
    return parse_robot_motion(bytes, robot_, "m", options);
  }
  static double distance(const RobotClip& a, const RobotClip& b) {
    const auto difference = value_of(compare_motions(motion_table(a), motion_table(b), 0.0));
    return difference.frames_a == difference.frames_b ? difference.largest : 1e9;
  }

  std::shared_ptr<const Robot> robot_ = load_g1();
};

TEST_F(RobotMotionTest, EveryFormatRoundTrips) {
  const RobotClip clip = walk(1.2);
  for (const MotionFormat format : kAllFormats) {
    WriteMotionOptions write;
    write.csv.precision = 12;
    write.tracking.rate = {30, 1};
    const auto bytes = value_of(format_robot_motion(clip, format, write));
    const auto motion = read(bytes);
    ASSERT_TRUE(motion) << format_name(format) << ": " << describe(motion.error());
    EXPECT_EQ(motion->format, format);
    RobotClip expected = clip;
    // Tracking files end one frame earlier, and PBHC's have no wrists.
    if (format_ending(format) == ".npz") {
      expected = RobotClip(robot_, {30, 1}, clip.frame_count() - 1);
      for (int i = 0; i < expected.frame_count(); ++i) {
        std::ranges::copy(clip.qpos(i), expected.qpos(i).begin());
      }
    }
    if (format == MotionFormat::kPklPbhc) {
      expected = with_robot(with_robot(clip, *pbhc_robot(robot_)), robot_);
    }
    const bool single = format == MotionFormat::kPklPbhc || format_ending(format) == ".npz";
    EXPECT_LT(distance(motion->clip, expected), single ? 1e-6 : 1e-11) << format_name(format);
    EXPECT_EQ(motion->clip.rate(), (FrameRate{30, 1}));
  }
}

TEST_F(RobotMotionTest, FindsQuaternionOrderAtEveryHeading) {
  for (const double heading : {-3.0, -1.6, -0.4, 0.0, 0.3, 1.0, 2.0, 3.1}) {
    const RobotClip clip = walk(heading);
    for (const QuaternionOrder order : {QuaternionOrder::kXyzw, QuaternionOrder::kWxyz}) {
      RobotCsvOptions csv;
      csv.precision = 9;
      csv.quaternion_order = order;
      const auto motion = read(format_robot_csv(clip, csv));
      ASSERT_TRUE(motion) << heading << describe(motion.error());
      EXPECT_LT(distance(motion->clip, clip), 1e-8)
          << heading << " " << (order == QuaternionOrder::kXyzw ? "xyzw" : "wxyz") << " "
          << motion->notes.back();
    }
  }
}

TEST_F(RobotMotionTest, AnOrderThatTheMotionDoesNotDecideIsTheUsualOne) {
  // On its back and still, with the head along x: both orders are the same rotation.
  std::string rows;
  for (int frame = 0; frame < 20; ++frame) {
    rows += "0,0,0.2,0.5,0.5,0.5,0.5";
    for (std::size_t i = 0; i < robot_->output_joints().size(); ++i) rows += ",0";
    rows += "\n";
  }
  const auto motion = value_of(read(rows));
  EXPECT_THAT(motion.warnings, Contains(HasSubstr("read as xyzw")));
}

TEST_F(RobotMotionTest, ContradictoryEvidenceGivesNoOrder) {
  OrderEvidence lying;
  lying.upright[0] = 0.38;
  lying.upright[1] = 0.9;
  lying.slip[0] = 0.012;
  lying.slip[1] = 0.033;
  EXPECT_FALSE(guess_order(lying, QuaternionOrder::kXyzw).order);
  EXPECT_TRUE(guess_order(lying, QuaternionOrder::kXyzw).contradictory);
  lying.slip[0] = 0.033;
  lying.slip[1] = 0.03;
  EXPECT_EQ(guess_order(lying, QuaternionOrder::kXyzw).order, QuaternionOrder::kWxyz);
}

TEST_F(RobotMotionTest, ReadsHeadersOfOtherTools) {
  const RobotClip clip = walk(0.5, 5);
  const std::string rows =
      format_robot_csv(clip, {.precision = 9, .quaternion_order = QuaternionOrder::kWxyz});
  std::string header =
      "root_pos_x,root_pos_y,root_pos_z,root_rot_w,root_rot_x,root_rot_y,root_rot_z";
  for (const int joint : robot_->output_joints()) {
    header += ",dof_" + robot_->joints()[joint].name + "(rad)";
  }
  const auto motion = value_of(read(header + "\n" + rows));
  EXPECT_LT(distance(motion.clip, clip), 1e-8);
  const auto wrong = read("x,y,z,qx,qy,qz,qw,left_knee_joint,left_nee_joint\n0,0,1,0,0,0,1,0,0\n");
  ASSERT_FALSE(wrong);
  EXPECT_THAT(describe(wrong.error()), HasSubstr("did you mean \"left_knee_joint\""));
}

TEST_F(RobotMotionTest, ResampledJointsStayInsideTheirLimits) {
  const auto limits = value_of(load_limits(*robot_, robot_->limits_for({})));
  const auto knee = static_cast<std::size_t>(*robot_->find_joint("left_knee_joint"));
  const auto address = static_cast<std::size_t>(robot_->joints()[knee].qpos_address);
  const double limit = limits.upper[knee];
  // It reaches the limit quickly and rests there, so that a spline overshoots.
  const auto highest = [&](double rest, double fps) {
    RobotClip clip(robot_, {30, 1}, 20);
    for (int i = 0; i < 20; ++i) clip.qpos(i)[address] = i < 8 ? limit - 0.1 * (8 - i) : rest;
    const auto resampled = resample_robot(clip, frame_rate_from_fps(fps));
    double most = 0.0;
    for (int i = 0; i < resampled->frame_count(); ++i) {
      most = std::max(most, resampled->qpos(i)[address]);
    }
    return most;
  };
  for (const double fps : {60.0, 47.0, 24.0}) EXPECT_LE(highest(limit, fps), limit) << fps;
  // A motion beyond its limits stays so.
  EXPECT_GE(highest(limit + 0.05, 60.0), limit + 0.05);
}

TEST_F(RobotMotionTest, HeldJointsStayAtTheirPosition) {
  const RobotClip clip = walk(0.5, 5);
  const auto held = value_of(robot_variant(robot_, "23-pbhc"));
  const auto bytes = format_robot_motion(clip, MotionFormat::kPklGmr);
  const auto motion = value_of(parse_robot_motion(*bytes, robot_, "m"));
  const RobotClip few = with_robot(motion.clip, held);
  EXPECT_EQ(few.robot().output_joints().size(), 23U);
  const auto wrist = robot_->find_joint("left_wrist_roll_joint");
  EXPECT_EQ(few.qpos(2)[robot_->joints()[*wrist].qpos_address], 0.0);
  EXPECT_LT(distance(with_robot(few, robot_), with_robot(with_robot(clip, held), robot_)), 1e-12);
}

TEST_F(RobotMotionTest, ReportsErrors) {
  const auto expect = [&](const std::string& text, const std::string& words) {
    const auto motion = read(text);
    ASSERT_FALSE(motion) << text.substr(0, 60);
    EXPECT_THAT(describe(motion.error()), HasSubstr(words));
    EXPECT_EQ(motion.error().kind, ErrorKind::kInput);
  };
  expect("", "no frames");
  expect("1,2,3\n", "3 columns, the robot unitree_g1 needs 36");
  expect("1,2,3\n1,2\n", "m:2:1: error: this line has 2 columns, those before it 3");
  expect("1,2,x\n", "m:1:5: error: expected a number, found \"x\"");
  expect("1,2,nan\n", "out of range");
  expect("HIERARCHY\nROOT Hips\n", "BVH");
  expect("BZh91AY", "bzip2");
  expect("\x80\x04}.", "not contain a robot motion");
  std::string row = "0,0,0.8,0,0,0,0";
  for (int i = 0; i < 29; ++i) row += ",0";
  expect(row + "\n", "length 0, expected 1");
}

TEST_F(RobotMotionTest, ResamplingKeepsTheMotion) {
  const RobotClip clip = walk(0.5, 61);
  const auto up = value_of(resample_robot(clip, {120, 1}));
  ASSERT_EQ(up.frame_count(), 241);
  const auto down = value_of(resample_robot(up, {30, 1}, {.antialias = false}));
  EXPECT_LT(distance(down, clip), 1e-12);
  // Compares with the functions, away from the ends.
  for (int frame = 20; frame < 220; ++frame) {
    const double t = frame / 120.0;
    EXPECT_NEAR(up.qpos(frame)[9], 0.2 + 0.3 * std::sin(6 * t + 9.0), 2e-5);
    EXPECT_NEAR(Eigen::Map<const Eigen::Vector4d>(up.qpos(frame).data() + 3).norm(), 1.0, 1e-12);
  }
}

TEST_F(RobotMotionTest, CountsDifferences) {
  const RobotClip a = walk(0.5);
  RobotClip b = a;
  b.qpos(7)[10] += 0.01;
  b.qpos(9)[10] -= 0.02;
  b.qpos(3)[0] += 1e-9;
  for (int i = 3; i < 7; ++i) b.qpos(12)[static_cast<std::size_t>(i)] *= -1.0;
  const auto found = value_of(compare_motions(motion_table(a), motion_table(b), 1e-6));
  EXPECT_FALSE(found.agree());
  ASSERT_EQ(found.columns.size(), 1U);
  EXPECT_EQ(found.columns[0].column, "left_knee_joint");
  EXPECT_EQ(found.columns[0].frames_beyond, 2U);
  EXPECT_EQ(found.columns[0].first_frame, 7U);
  EXPECT_EQ(found.columns[0].largest_frame, 9U);
  EXPECT_NEAR(found.columns[0].largest, 0.02, 1e-12);
  EXPECT_TRUE(compare_motions(motion_table(a), motion_table(b), 0.1)->agree());
  const auto shorter = compare_motions(motion_table(a), motion_table(walk(0.5, 39)), 1e-6);
  EXPECT_THAT(shorter->columns, IsEmpty());
  EXPECT_FALSE(shorter->agree());
  b.qpos(1)[8] = std::nan("");
  EXPECT_TRUE(std::isinf(compare_motions(motion_table(a), motion_table(b), 1.0)->largest));
}

}  // namespace
}  // namespace retarget
