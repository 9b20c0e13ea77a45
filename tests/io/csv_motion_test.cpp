#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "retarget/motion_io.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kRow = "1,2,3,0,0,0,1,.1,.2,.3,.04,.5\n";
constexpr const char* kRoot = "x,y,z,qx,qy,qz,qw,";
constexpr const char* kJoints = "left_shoulder,left_elbow,left_twist,right_slide,right_shoulder";

template <typename Set>
ReadMotionOptions with(const Set& set) {
  ReadMotionOptions options;
  set(options);
  return options;
}

// Root, then left_shoulder left_elbow left_twist right_slide right_shoulder.
class CsvMotion : public ::testing::Test {
 protected:
  Result<RobotMotion> read(const std::string& text, ReadMotionOptions options = {}) const {
    options.metres_per_unit = 1.0;
    return parse_robot_motion(text, robot_, "m.csv", options);
  }
  void expect_pose(const std::string& text, const ReadMotionOptions& options = {}) const {
    const auto motion = read(text, options);
    ASSERT_TRUE(motion) << text << describe(motion.error());
    EXPECT_THAT(motion->clip.qpos(0), ElementsAre(1, 2, 3, 1, 0, 0, 0, .1, .2, .3, .04, .5))
        << text;
  }
  void expect_fault(const std::string& text, const ::testing::Matcher<std::string>& words,
                    const ReadMotionOptions& options = {}) const {
    const auto motion = read(text, options);
    ASSERT_FALSE(motion) << text;
    EXPECT_THAT(describe(motion.error()), words) << text;
    EXPECT_EQ(motion.error().kind, ErrorKind::kInput);
  }
  // Rows of the standing robot, with a first column.
  static std::string timed(const std::vector<std::string>& times, const std::string& name = {}) {
    std::string text = name.empty() ? "" : name + "," + kRoot + kJoints + "\n";
    for (const std::string& time : times) text += time + "," + kRow;
    return text;
  }

  std::shared_ptr<const Robot> robot_ = robot_from_text(kTwoArms);
};

TEST_F(CsvMotion, ReadsManyLayouts) {
  for (const std::string& text :
       {std::string(kRow), "\xEF\xBB\xBF" + std::string(kRow),
        "# made by hand\n\n" + std::string(kRow),
        std::string("1, 2, 3, 0, 0, 0, 1, .1, .2, .3, .04, .5\r\n"),
        std::string("  1 2 3 0 0 0 +1 .1 .2 .3 .04 .5"),
        std::string("1\t2\t3\t0\t0\t0\t1\t.1\t.2\t\t.3\t.04\t.5\t\r\n"),
        std::string("1;2;3;0;0;0;1;.1;.2;.3;.04;.5"),
        std::string(R"("1","2","3","0","0","0","1",".1",".2",".3",".04",".5")"),
        std::string("0,1,2,3,0,0,0,1,.1,.2,.3,.04,.5")}) {
    expect_pose(text);
  }
}

TEST_F(CsvMotion, ReadsManyHeaderStyles) {
  const std::string names = std::string(kRoot) + kJoints;
  expect_pose(names + "\n" + kRow);
  expect_pose("\xEF\xBB\xBF" + names + "\r\n" + kRow);
  // In quotes, with blanks, in capitals, separated by semicolons.
  expect_pose(R"("x","y","z","qx","qy","qz","qw","left_shoulder","left_elbow","left_twist",)"
              R"("right_slide","right_shoulder")"
              "\n" +
              std::string(kRow));
  expect_pose(
      "Root X, Root Y, Root Z, Root QX, Root QY, Root QZ, Root QW, Left_Shoulder, LEFT_ELBOW,"
      "Left Twist, right_slide, right_shoulder\n" +
      std::string(kRow));
  expect_pose(
      "\"x\";\"y\";\"z\";\"qx\";\"qy\";\"qz\";\"qw\";left_shoulder;left_elbow;left_twist;"
      "right_slide;right_shoulder\n1;2;3;0;0;0;1;.1;.2;.3;.04;.5\n");
  // With paths, units, and prefixes and suffixes of table exports.
  expect_pose(
      "robot/root/x,robot/root/y,robot/root/z,robot/root/qx,robot/root/qy,robot/root/qz,"
      "robot/root/qw,robot/left_shoulder,robot/left_elbow,robot/left_twist,"
      "robot/right_slide,robot/right_shoulder\n" +
      std::string(kRow));
  expect_pose(
      "/r1/base/position/x,/r1/base/position/y,/r1/base/position/z,"
      "/r1/base/orientation/x,/r1/base/orientation/y,/r1/base/orientation/z,"
      "/r1/base/orientation/w,/r1/joint_states/left_shoulder/position,"
      "/r1/joint_states/left_elbow/position,/r1/joint_states/left_twist/position,"
      "/r1/joint_states/right_slide/position,/r1/joint_states/right_shoulder/position\n" +
      std::string(kRow));
  expect_pose(
      "root_x (m),root_y (m),root_z (m),root_qx,root_qy,root_qz,root_qw,"
      "dof_left_shoulder(rad),left_elbow_dof,left_twist [rad],right_slide_pos,"
      "right_shoulder_rad\n" +
      std::string(kRow));
  // The index of a data frame; a header in a comment.
  expect_pose("," + names + "\n0," + kRow);
  expect_pose("# " + names + "\n" + kRow);
  // In another order.
  expect_pose(
      "right_shoulder,right_slide,left_twist,left_elbow,left_shoulder,qw,qx,qy,qz,z,y,x\n"
      ".5,.04,.3,.2,.1,1,0,0,0,3,2,1\n");
}

TEST_F(CsvMotion, RejectsUnknownHeaders) {
  const std::string letters = "a,b,c,d,e,f,g,h,i,j,k,l\n" + std::string(kRow);
  expect_fault(letters, AllOf(HasSubstr("the header is not understood: \"a\", \"b\""),
                              HasSubstr("ignore_header")));
  expect_pose(letters, with([](auto& o) { o.ignore_header = true; }));
  expect_fault("x,y,z,w,qx,qy,qz,left_sholder,right_slide\n0,0,1,1,0,0,0,0,0\n",
               HasSubstr("did you mean \"left_shoulder\"?"));
  expect_fault(std::string(kRoot) + kJoints + ",left_elbow_vel,foo\n" +
                   std::string("1,2,3,0,0,0,1,.1,.2,.3,.04,.5,0,0\n"),
               HasSubstr("\"left_elbow_vel\", \"foo\", which are not joints of the robot"));
  expect_fault("x,y,z,w,qx,qy,qz,left_elbow,left_elbow\n0,0,1,1,0,0,0,0,0\n",
               HasSubstr("a joint twice"));
  expect_fault("x,y,z,qx,qy,qz,qw,base_x,left_elbow\n0,0,1,0,0,0,1,0,0\n",
               HasSubstr("a part of the root twice"));
  expect_fault("x,y,z,qx,qy,qz,qw,left_elbow(rad),left_twist(deg)\n0,0,1,0,0,0,1,0,0\n",
               HasSubstr("radians and degrees"));
  expect_fault("x,y,z,left_shoulder\n1,2,3,4\n", HasSubstr("four of its quaternion"));
  // A short row, decimal commas, two bytes per letter.
  expect_fault(std::string(kRoot) + kJoints + "\n1,2,3\n", HasSubstr("the header has 12 columns"));
  expect_fault("1,5;2;3;0;0;0;1;.1;.2;.3;.4;.5\n",
               AllOf(HasSubstr("m.csv:1:1: error: expected a number, found \"1,5\""),
                     HasSubstr("use a decimal point")));
  expect_fault(std::string("\xFF\xFEx\0,\0", 6), HasSubstr("UTF-16"));
}

TEST_F(CsvMotion, RejectsHeadersWithMissingJoints) {
  expect_fault("x,y,z,qx,qy,qz,qw,left_shoulder,right_shoulder\n1,2,3,0,0,0,1,.1,.5\n",
               AllOf(HasSubstr("the header names 2 joints"),
                     HasSubstr("left_elbow, left_twist, right_slide")));
}

TEST_F(CsvMotion, AcceptsHeadersWithoutVariantJoints) {
  const auto g1 = load_g1();
  const auto few = value_of(robot_variant(g1, "23-pbhc"));
  RobotCsvOptions named;
  named.header = true;
  RobotClip clip(few, {30, 1}, 2);
  for (int frame = 0; frame < 2; ++frame) {
    clip.qpos(frame)[2] = 0.8;
    clip.qpos(frame)[3] = 1.0;
  }
  const auto sound = value_of(parse_robot_motion(format_robot_csv(clip, named), g1, "m.csv"));
  EXPECT_THAT(sound.warnings, Contains(AllOf(HasSubstr("6 of the robot's 29 joints"),
                                             HasSubstr("left_wrist_roll_joint"))));
  const auto told = value_of(parse_robot_motion(format_robot_csv(clip, named), g1, "m.csv",
                                                with([](auto& o) { o.variant = "23-pbhc"; })));
  EXPECT_THAT(told.warnings, IsEmpty());
}

TEST_F(CsvMotion, ReadsItsOwnHeadersOfJointsWithDelimiters) {
  std::string model = kTwoArms;
  for (std::size_t at = 0; (at = model.find("\"left_elbow\"", at)) != std::string::npos; ++at) {
    model.replace(at, 12, "\"left, &quot;bent&quot;; elbow\"");
  }
  const auto robot = robot_from_text(model);
  ASSERT_TRUE(robot->find_joint("left, \"bent\"; elbow"));
  RobotClip clip(robot, {30, 1}, 1);
  std::ranges::copy(std::vector{1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3, 0.04, 0.5},
                    clip.qpos(0).begin());
  for (const char delimiter : {',', ' ', '\t'}) {
    RobotCsvOptions named;
    named.header = true;
    named.delimiter = delimiter;
    const auto read = value_of(parse_robot_motion(format_robot_csv(clip, named), robot, "m.csv",
                                                  with([](auto& o) { o.metres_per_unit = 1.0; })));
    EXPECT_EQ(read.clip.qpos(0)[8], 0.2);
  }
  RobotCsvOptions named;
  named.header = true;
  EXPECT_NE(format_robot_csv(clip, named).find(R"(,"left, ""bent""; elbow",)"), std::string::npos);
}

TEST_F(CsvMotion, ReadsRateFromTimes) {
  const auto rate_of = [&](const std::vector<std::string>& times, const std::string& name = {}) {
    const auto motion = value_of(read(timed(times, name)));
    return motion.rate_known ? to_text(motion.clip.rate()) : "none";
  };
  EXPECT_EQ(rate_of({"0", "0.02", "0.04", "0.06"}), "50");
  EXPECT_EQ(rate_of({"10.5", "10.52", "10.54"}, "time"), "50");
  // Rounded times.
  EXPECT_EQ(rate_of({"0.000", "0.033", "0.067", "0.100"}), "30");
  EXPECT_EQ(rate_of({"0", "33", "67", "100"}), "30");
  EXPECT_EQ(rate_of({"0", "8", "17", "25", "33"}, "t"), "120");
  EXPECT_EQ(rate_of({"0", "20", "40"}, "time_ms"), "50");
  EXPECT_EQ(rate_of({"0", "20", "40"}, "Time [ms]"), "50");
  EXPECT_EQ(rate_of({"0", "2", "4"}, "time (s)"), "0.5");
  EXPECT_EQ(rate_of({"1700000000.00", "1700000000.02", "1700000000.04"}, "timestamp"), "50");
  EXPECT_EQ(
      rate_of({"1700000000000000000", "1700000000020000000", "1700000000040000000"}, "timestamp"),
      "50");
  EXPECT_EQ(rate_of({"0", "0.01", "0.03", "0.04", "0.05", "0.07", "0.08"}, "time"), "72");
  // A recorded clock with a late and an early time.
  EXPECT_EQ(rate_of({"0", "0.0101", "0.0170", "0.0335", "0.0400", "0.0500"}, "time"), "100");
  // Frame numbers do not determine a rate.
  EXPECT_EQ(rate_of({"5", "6", "7"}), "none");
  EXPECT_EQ(rate_of({"0", "1", "2"}, "frame"), "none");
}

TEST_F(CsvMotion, RejectsAmbiguousTimesUnlessTheRateIsGiven) {
  const ReadMotionOptions at_60 = with([](auto& o) { o.rate = FrameRate{60, 1}; });
  for (const auto& [text, words] :
       {std::pair(timed({"0", "1", "2"}, "time"), "does not determine the rate"),
        {timed({"0", "4", "8"}), "frame numbers or times"},
        {timed({"0", ".02", ".02", ".04"}, "time"), "does not increase"},
        {timed({"0", ".02", ".04", ".5", ".52"}, "time"), "is not uniform"},
        {timed({"0", ".02", ".04", ".08", ".1", ".12"}, "time"), "line 5 comes 0.04 s after"},
        {timed({"0", "33", "67", "133", "167", "200"}), "line 4 comes 0.066 s after"}}) {
    expect_fault(text, AllOf(HasSubstr(words), HasSubstr("source_fps")));
    const auto given = value_of(read(text, at_60));
    EXPECT_EQ(given.clip.rate(), (FrameRate{60, 1}));
    EXPECT_THAT(given.warnings, Contains(HasSubstr(words)));
  }
  // The file's times contradict the requested rate.
  const auto against = value_of(read(timed({"0", ".02", ".04"}, "time"), at_60));
  EXPECT_THAT(against.warnings,
              Contains(AllOf(HasSubstr("50 a second"), HasSubstr("using the requested 60 fps"))));
  const auto gaps = value_of(read(timed({"0", "1", "5", "6"}, "frame")));
  EXPECT_THAT(gaps.warnings, Contains(HasSubstr("frames missing")));
}

TEST_F(CsvMotion, ReadsSomaRateFromFrameNumbers) {
  RobotClip clip(robot_, {30, 1}, 4);
  for (int frame = 0; frame < 4; ++frame) {
    clip.qpos(frame)[2] = 1.0;
    clip.qpos(frame)[3] = 1.0;
  }
  const auto rate_of = [&](const FrameRate& rate, const ReadMotionOptions& options = {}) {
    const auto motion = value_of(
        parse_robot_motion(format_robot_csv(clip, soma_csv_options(rate)), robot_, "m", options));
    return to_text(motion.clip.rate()) + (motion.rate_known ? "" : " assumed");
  };
  EXPECT_EQ(rate_of({30, 1}), "30");
  EXPECT_EQ(rate_of({24, 1}), "24");
  EXPECT_EQ(rate_of({120, 1}), "120 assumed");
  EXPECT_EQ(rate_of({50, 1}), "120 assumed");
  EXPECT_EQ(rate_of({50, 1}, with([](auto& o) {
                      o.default_rate = FrameRate{50, 1};
                    })),
            "50 assumed");
  EXPECT_EQ(rate_of({30, 1}, with([](auto& o) { o.default_rate = FrameRate{50, 1}; })), "30");
}

TEST_F(CsvMotion, RejectsMissingSomaFrames) {
  RobotClip clip(robot_, {30, 1}, 4);
  std::string text = format_robot_csv(clip, soma_csv_options({30, 1}));
  const std::size_t second = text.find("\n4,");
  text.erase(second, text.find('\n', second + 1) - second);
  const auto gap = parse_robot_motion(text, robot_, "m", {});
  ASSERT_FALSE(gap);
  EXPECT_THAT(describe(gap.error()), AllOf(HasSubstr("frames missing"), HasSubstr("source_fps")));
}

TEST_F(CsvMotion, AngleUnitAppliesToRootAndJoints) {
  const std::string header =
      "Frame,root_translateX,root_translateY,root_translateZ,root_rotateX,root_rotateY,"
      "root_rotateZ,left_shoulder_dof,left_elbow_dof,left_twist_dof,right_slide_dof,"
      "right_shoulder_dof\n";
  // A quarter turn about z.
  const std::string degrees = header + "0,0,0,1,0,0,90,0,0,90,0,0\n";
  const std::string radians =
      header + "0,0,0,1,0,0,1.5707963267948966,0,0,1.5707963267948966,0,0\n";
  const auto a = value_of(parse_robot_motion(degrees, robot_, "m", {}));
  const auto b = value_of(parse_robot_motion(radians, robot_, "m", with([](auto& o) {
                                               o.degrees = false;
                                               o.metres_per_unit = 0.01;
                                             })));
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(a.clip.qpos(0)[i], b.clip.qpos(0)[i], 1e-15);
  EXPECT_NEAR(a.clip.qpos(0)[6], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(a.clip.qpos(0)[2], 0.01, 1e-15);
  EXPECT_THAT(b.warnings, Contains(HasSubstr("angles in degrees; using the requested radians")));
}

TEST_F(CsvMotion, ErrorsHaveLineAndColumn) {
  expect_fault("", HasSubstr("no frames"));
  expect_fault("# nothing\n", HasSubstr("no frames"));
  expect_fault("1,2,3\n", HasSubstr("m.csv:1:1: error: this line has 3 columns"));
  expect_fault(std::string(kRow) + "1,2,3\n",
               HasSubstr("m.csv:2:1: error: this line has 3 columns, those"));
  expect_fault("1,2,x,0,0,0,1,.1,.2,.3,.4,.5\n", HasSubstr("m.csv:1:5: error: expected a number"));
  expect_fault("1,2,,0,0,0,1,.1,.2,.3,.4,.5\n",
               HasSubstr("m.csv:1:5: error: expected a number, found \"\""));
  expect_fault("1,2,+-1,0,0,0,1,.1,.2,.3,.4,.5\n",
               HasSubstr("m.csv:1:5: error: expected a number, found \"+-1\""));
  expect_fault("1,2,nan,0,0,0,1,.1,.2,.3,.4,.5\n", HasSubstr("m.csv:1:5: error: the number nan"));
  expect_fault("1,2,-1e7,0,0,0,1,.1,.2,.3,.4,.5\n", HasSubstr("is out of range"));
  expect_fault("1e7,2,1,0,0,0,1,.1,.2,.3,.4,.5\n", HasSubstr("beyond 1e6"));
  expect_fault("5,1,2,3,0,0,0,1,.1,.2,.3,.4,.5\n5,1,2,3,0,0,0,1,.1,.2,.3,.4,.5\n",
               HasSubstr("this line has 13 columns"));
}

TEST_F(CsvMotion, RejectsHostileBytes) {
  for (const std::string& bytes :
       {std::string(100000, ','), std::string(100000, '9'), std::string(5000, '\xff'),
        std::string(kRow) + std::string(20, '\0'), std::string("1e999,") + kRow,
        std::string(100000, '"'), "\"" + std::string(100000, ','), std::string(3, '\0')}) {
    EXPECT_FALSE(read(bytes));
  }
}

TEST_F(CsvMotion, LinesMayEndWithCarriageReturns) {
  std::string text = std::string(kRoot) + kJoints + "\n" + kRow + kRow;
  std::ranges::replace(text, '\n', '\r');
  expect_pose(text);
  EXPECT_EQ(read(text)->clip.frame_count(), 2);
}

TEST_F(CsvMotion, ANumberThatIsCutOffIsAWarning) {
  const std::string row = "1,2,3,0,0,0,1,.1,.2,.3,.04,.5000\n";
  const std::string rows = row + row + row + row;
  EXPECT_THAT(read(rows)->warnings, IsEmpty());
  EXPECT_THAT(read(rows.substr(0, rows.size() - 1))->warnings, IsEmpty());
  EXPECT_THAT(read(rows.substr(0, rows.size() - 3))->warnings,
              Contains(AllOf(HasSubstr("line 4"), HasSubstr("not have been copied completely"))));
  // Lines whose numbers differ in length prove nothing.
  const std::string uneven = row + "1,2,3,0,0,0,1,.1,.2,.3,.04,.51\n" + row + row;
  EXPECT_THAT(read(uneven.substr(0, uneven.size() - 3))->warnings, IsEmpty());
}

}  // namespace
}  // namespace retarget
