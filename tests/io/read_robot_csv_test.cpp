#include "retarget/io/read_robot_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/test_robots.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// root, then left_shoulder left_elbow left_twist right_slide right_shoulder
class ReadRobotCsv : public ::testing::Test {
 protected:
  Result<RobotClip> read(std::string_view text, const ReadRobotCsvOptions& options = {}) const {
    return parse_robot_csv(text, robot_, {30, 1}, "m.csv", options);
  }
  void expect_fault(std::string_view text, const std::string& words) const {
    const auto clip = read(text);
    ASSERT_FALSE(clip) << text;
    EXPECT_THAT(describe(clip.error()), HasSubstr(words));
    EXPECT_EQ(clip.error().kind, ErrorKind::kInput);
  }

  std::shared_ptr<const Robot> robot_ = robot_from_text(kTwoArms);
};

constexpr const char* kRow = "1,2,3,0,0,0,1,.1,.2,.3,.4,.5\n";

TEST_F(ReadRobotCsv, ReadsWhatIsWritten) {
  RobotClip clip(robot_, {30, 1}, 3);
  for (int frame = 0; frame < 3; ++frame) {
    for (double& value : clip.qpos(frame)) value = 0.125 * frame;
    const Eigen::Quaterniond turn = Eigen::Quaterniond(1.0, 0.25, -0.5, 0.125 * frame).normalized();
    clip.qpos(frame)[3] = turn.w();
    clip.qpos(frame)[4] = turn.x();
    clip.qpos(frame)[5] = turn.y();
    clip.qpos(frame)[6] = turn.z();
  }
  for (const char delimiter : {',', ' ', '\t'}) {
    for (const bool header : {false, true}) {
      for (const QuaternionOrder order : {QuaternionOrder::kXyzw, QuaternionOrder::kWxyz}) {
        const auto text = format_robot_csv(clip, {15, delimiter, header, order});
        // a header tells the order
        const auto found = read(text, {header ? QuaternionOrder::kXyzw : order});
        ASSERT_TRUE(found) << describe(found.error());
        ASSERT_EQ(found->frame_count(), 3);
        for (int frame = 0; frame < 3; ++frame) {
          for (std::size_t i = 0; i < clip.qpos(frame).size(); ++i) {
            EXPECT_NEAR(found->qpos(frame)[i], clip.qpos(frame)[i], 1e-14);
          }
        }
      }
    }
  }
}

TEST_F(ReadRobotCsv, TakesManyLayouts) {
  for (const std::string& text :
       {std::string(kRow), "\xEF\xBB\xBF" + std::string(kRow),
        "# made by hand\n\n" + std::string(kRow),
        std::string("1, 2, 3, 0, 0, 0, 1, .1, .2, .3, .4, .5\r\n"),
        std::string("  1 2 3 0 0 0 +1 .1 .2 .3 .4 .5"), std::string("1;2;3;0;0;0;2;.1;.2;.3;.4;.5"),
        std::string("0,1,2,3,0,0,0,1,.1,.2,.3,.4,.5"),
        std::string("a,b,c,d,e,f,g,h,i,j,k,l\n") + kRow}) {
    const auto clip = read(text);
    ASSERT_TRUE(clip) << text << describe(clip.error());
    ASSERT_EQ(clip->frame_count(), 1) << text;
    EXPECT_THAT(clip->qpos(0), ElementsAre(1, 2, 3, 1, 0, 0, 0, .1, .2, .3, .4, .5)) << text;
  }
}

TEST_F(ReadRobotCsv, ColumnsFollowAHeaderThatNamesJoints) {
  const auto clip = read(
      "x,y,z,w,qx,qy,qz,right_shoulder,right_slide,left_twist,left_elbow,left_shoulder\n"
      "1,2,3,1,0,0,0,.1,.2,.3,.4,.5\n");
  ASSERT_TRUE(clip) << describe(clip.error());
  EXPECT_THAT(clip->qpos(0), ElementsAre(1, 2, 3, 1, 0, 0, 0, .5, .4, .3, .2, .1));
  expect_fault("x,y,z,w,qx,qy,qz,left_sholder,right_slide\n", "did you mean \"left_shoulder\"?");
  expect_fault("x,y,z,w,qx,qy,qz,left_elbow,left_elbow\n", "names a joint twice");
}

TEST_F(ReadRobotCsv, QuaternionsAreSignContinuous) {
  const auto clip = read("1,2,3,0,0,0,1,.1,.2,.3,.4,.5\n1,2,3,0,0,-0.1,-1,.1,.2,.3,.4,.5\n");
  ASSERT_TRUE(clip);
  EXPECT_GT(clip->qpos(1)[3], 0.9);
}

TEST_F(ReadRobotCsv, FaultsHaveLineAndColumn) {
  expect_fault("", "no frames");
  expect_fault("# nothing\n", "no frames");
  expect_fault("1,2,3\n", "m.csv:1:1: error: this line has 3 columns");
  expect_fault(std::string(kRow) + "1,2,3\n", "m.csv:2:1: error: this line has 3 columns, those");
  expect_fault("1,2,x,0,0,0,1,.1,.2,.3,.4,.5\n", "m.csv:1:5: error: expected a number");
  expect_fault("1,2,,0,0,0,1,.1,.2,.3,.4,.5\n", "m.csv:1:5: error: expected a number, found \"\"");
  expect_fault("1,2,nan,0,0,0,1,.1,.2,.3,.4,.5\n", "m.csv:1:5: error: the number nan");
  expect_fault("1,2,-1e7,0,0,0,1,.1,.2,.3,.4,.5\n", "is out of range");
  expect_fault("1,2,3,0,0,0,0,.1,.2,.3,.4,.5\n", "m.csv:1:7: error: the root's quaternion is zero");
  expect_fault("5,1,2,3,0,0,0,1,.1,.2,.3,.4,.5\n5,1,2,3,0,0,0,1,.1,.2,.3,.4,.5\n",
               "m.csv:2:1: error: one column too many");
  expect_fault(std::string("\0\0\0", 3), "no frames");
}

TEST_F(ReadRobotCsv, HostileBytesGiveFaults) {
  for (const std::string& bytes :
       {std::string(100000, ','), std::string(100000, '9'), std::string(5000, '\xff'),
        std::string(kRow) + std::string(20, '\0'), std::string("1e999,") + kRow}) {
    EXPECT_FALSE(read(bytes));
  }
}

}  // namespace
}  // namespace retarget
