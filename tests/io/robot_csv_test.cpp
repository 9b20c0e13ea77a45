#include "retarget/motion_io.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>

#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// Two frames of the two-armed robot with recognisable numbers.
RobotClip two_frames() {
  RobotClip clip(robot_from_text(kTwoArms), {30, 1}, 2);
  const auto first = clip.qpos(0);
  const double root[7] = {1.5, -2.25, 0.1234567, 0.5, -0.5, 0.5, -0.5};
  std::copy(std::begin(root), std::end(root), first.begin());
  for (std::size_t i = 7; i < first.size(); ++i) first[i] = -1e-7;
  const auto second = clip.qpos(1);
  for (std::size_t i = 0; i < second.size(); ++i) second[i] = static_cast<double>(i);
  return clip;
}

TEST(RobotCsv, WritesTheBytesOfThePublishedData) {
  EXPECT_EQ(format_robot_csv(two_frames()),
            "1.500000,-2.250000,0.123457,-0.500000,0.500000,-0.500000,0.500000,"
            "0.000000,0.000000,0.000000,0.000000,0.000000\n"
            "0.000000,1.000000,2.000000,4.000000,5.000000,6.000000,3.000000,"
            "7.000000,8.000000,9.000000,10.000000,11.000000\n");
}

TEST(RobotCsv, WritesOtherDialects) {
  RobotCsvOptions options;
  options.precision = 1;
  options.delimiter = '\t';
  options.header = true;
  options.quaternion_order = QuaternionOrder::kWxyz;
  EXPECT_EQ(
      format_robot_csv(two_frames(), options),
      "root_x\troot_y\troot_z\troot_qw\troot_qx\troot_qy\troot_qz\tleft_shoulder\tleft_elbow\t"
      "left_twist\tright_slide\tright_shoulder\n"
      "1.5\t-2.2\t0.1\t0.5\t-0.5\t0.5\t-0.5\t0.0\t0.0\t0.0\t0.0\t0.0\n"
      "0.0\t1.0\t2.0\t3.0\t4.0\t5.0\t6.0\t7.0\t8.0\t9.0\t10.0\t11.0\n");
  options.precision = 0;
  options.header = false;
  options.delimiter = ' ';
  EXPECT_EQ(format_robot_csv(two_frames(), options),
            "2 -2 0 0 0 0 0 0 0 0 0 0\n0 1 2 3 4 5 6 7 8 9 10 11\n");
}

TEST(RobotCsv, KeepsEveryDigitIfRequested) {
  RobotCsvOptions options;
  options.precision = 17;
  RobotClip clip = two_frames();
  clip.qpos(0)[0] = 0.1;
  EXPECT_EQ(format_robot_csv(clip, options).substr(0, 19), "0.10000000000000001");
}

TEST(RobotCsv, HasNoNegativeZero) {
  RobotClip clip = two_frames();
  clip.qpos(0)[0] = -4.9e-7;
  clip.qpos(0)[1] = -0.0;
  clip.qpos(0)[2] = -5.1e-7;
  EXPECT_EQ(format_robot_csv(clip).substr(0, 27), "0.000000,0.000000,-0.000001");
}

TEST(RobotCsv, IsTheSameInEveryLocale) {
  const std::string before = format_robot_csv(two_frames());
  const char* const old = std::setlocale(LC_NUMERIC, nullptr);
  const std::string kept = old;
  for (const char* locale : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_NUMERIC, locale) != nullptr) {
      EXPECT_EQ(format_robot_csv(two_frames()), before) << locale;
    }
  }
  std::setlocale(LC_NUMERIC, kept.c_str());
}

TEST(RobotCsv, ClampsPrecision) {
  RobotCsvOptions options;
  options.precision = 2'000'000'000;
  RobotCsvOptions max;
  max.precision = 17;
  RobotClip clip = two_frames();
  clip.qpos(0)[0] = -1.7e308;
  EXPECT_EQ(format_robot_csv(clip, options), format_robot_csv(clip, max));
  options.precision = -5;
  EXPECT_EQ(format_robot_csv(two_frames(), options).substr(0, 5), "2,-2,");
}

TEST(RobotCsv, SomaFrameNumbersCountAt120Fps) {
  const auto frame_numbers = [](const FrameRate& rate) {
    RobotClip clip(robot_from_text(kTwoArms), rate, 3);
    const std::string text = format_robot_csv(clip, soma_csv_options(rate));
    std::string numbers;
    for (std::size_t at = text.find('\n'); at + 1 < text.size(); at = text.find('\n', at + 1)) {
      numbers += text.substr(at + 1, text.find(',', at) - at);
    }
    return numbers;
  };
  EXPECT_EQ(frame_numbers({120, 1}), "0,1,2,");
  EXPECT_EQ(frame_numbers({30, 1}), "0,4,8,");
  EXPECT_EQ(frame_numbers({60, 1}), "0,2,4,");
  // Frame numbers cannot represent these rates.
  for (const FrameRate& rate : {FrameRate{50, 1}, {240, 1}, {2997, 125}}) {
    EXPECT_FALSE(soma_csv_tells(rate));
    EXPECT_EQ(frame_numbers(rate), "0,1,2,");
  }
}

TEST(RobotCsv, PrintedClipsRoundTrip) {
  RobotClip clip = two_frames();
  const auto printed = value_of(printed_clip(clip, {.precision = 3}));
  EXPECT_EQ(printed.qpos(0)[2], 0.123);
  EXPECT_FALSE(std::signbit(printed.qpos(0)[7]));
  EXPECT_EQ(printed.qpos(1)[11], 11.0);
  for (int frame = 0; frame < 2; ++frame) {
    const auto q = printed.qpos(frame);
    EXPECT_NEAR(q[3] * q[3] + q[4] * q[4] + q[5] * q[5] + q[6] * q[6], 1.0, 1e-15);
  }
  // The quaternion keeps its sign: 3, 4, 5, 6 is in the hemisphere opposite to .5, -.5, .5, -.5.
  EXPECT_LT(printed.qpos(1)[3], 0.0);
  const auto nothing = printed_clip(clip, {.precision = 0});
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().message.find("rounds to zero with 0 digits"), std::string::npos);
}

// Numbers are rounded in the units of the file.
TEST(RobotCsv, PrintedClipsAreThoseOfTheFile) {
  RobotClip clip = two_frames();
  const double turn[4] = {0.8, 0.36, -0.48, 0.0};
  std::copy(std::begin(turn), std::end(turn), clip.qpos(1).begin() + 3);
  for (std::size_t i = 7; i < 12; ++i) clip.qpos(1)[i] = 0.0123456 * static_cast<double>(i);
  RobotCsvOptions units;
  units.precision = 2;
  units.header = units.degrees = units.centimetres = true;
  for (const RobotCsvOptions& options : {units, soma_csv_options(clip.rate(), 2)}) {
    const auto printed = value_of(printed_clip(clip, options));
    const auto read =
        value_of(parse_robot_motion(format_robot_csv(clip, options), clip.shared_robot(), "a"));
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      const auto is = printed.qpos(frame), as = read.clip.qpos(frame);
      for (std::size_t i = 0; i < is.size(); ++i) EXPECT_NEAR(is[i], as[i], 1e-12) << i;
    }
  }
}

TEST(RobotCsv, EmptyClipGivesAnEmptyFile) {
  EXPECT_EQ(format_robot_csv(RobotClip(robot_from_text(kTwoArms), {30, 1}, 0)), "");
}

}  // namespace
}  // namespace retarget
