#include "formats/bvh/read_bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bvh_test_support.h"
#include "retarget/clip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kHierarchy = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT A
  {
    OFFSET 0 1 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 1 0
    }
  }
}
)";

// A row of the skeleton above; the number makes rows differ.
std::string row(int number) {
  return std::to_string(number) + " 2 3 10 20 30 40 50 60\n";
}

std::string rows(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += row(i);
  return text;
}

std::string motion(const std::string& frames, const std::string& data) {
  return std::string(kHierarchy) + "MOTION\nFrames: " + frames + "\nFrame Time: 0.033333\n" + data;
}

// A single-line root, for errors inside it.
std::string root(const std::string& inside) {
  return "HIERARCHY\nROOT Hips\n{\n" + inside + "\n}\nMOTION\nFrames: 0\nFrame Time: 1\n";
}

BvhReadOptions lenient() {
  BvhReadOptions options;
  options.lenient = true;
  return options;
}

std::string error_of(const std::string& text, const BvhReadOptions& options = {}) {
  const Result<BvhFile> file = read_exactly(text, options);
  EXPECT_FALSE(file.has_value()) << text;
  return file ? "" : describe(file.error());
}

std::vector<double> first_values(const Clip& clip) {
  std::vector<double> values;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    values.push_back(clip.translations(frame)[0].x());
  }
  return values;
}

// Semantics.

TEST(ReadBvh, RotationsComposeLeftToRightInDegrees) {
  const Clip clip = clip_of(motion("1", "1 2 3 10 20 30 40 50 60"));
  const auto turn = [](double degrees, int axis) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::Unit(axis))
        .toRotationMatrix();
  };
  const Eigen::Matrix3d hips = turn(10, 2) * turn(20, 0) * turn(30, 1);
  const Eigen::Matrix3d a = turn(40, 2) * turn(50, 0) * turn(60, 1);
  EXPECT_LT((clip.rotations(0)[0].toRotationMatrix() - hips).norm(), 1e-14);
  EXPECT_LT((clip.rotations(0)[1].toRotationMatrix() - a).norm(), 1e-14);

  std::vector<Pose> world(2);
  forward_kinematics(clip, 0, world);
  const Eigen::Vector3d expected = Eigen::Vector3d(1, 2, 3) + hips * Eigen::Vector3d(0, 1, 0);
  EXPECT_LT((world[1].translation - expected).norm(), 1e-14);
}

TEST(ReadBvh, PositionReplacesOffsetPerAxis) {
  const Clip clip = clip_of(
      "HIERARCHY ROOT a { OFFSET 7 8 9 CHANNELS 1 Yposition JOINT b { OFFSET 1 2 3 CHANNELS 2 "
      "Zposition Xposition } JOINT c { OFFSET 4 5 6 CHANNELS 0 } }\n"
      "MOTION\nFrames: 2\nFrame Time: 0.1\n-1 30 10\n-2 0 0\n");
  EXPECT_EQ(clip.translation(0, 0), Eigen::Vector3d(7, -1, 9));
  EXPECT_EQ(clip.translation(0, 1), Eigen::Vector3d(10, 2, 30));
  EXPECT_EQ(clip.translation(1, 1), Eigen::Vector3d(0, 2, 0));
  EXPECT_EQ(clip.translation(1, 2), Eigen::Vector3d(4, 5, 6));
}

TEST(ReadBvh, AllZeroPositionsKeepTheOffset) {
  const std::string hierarchy =
      "HIERARCHY\nROOT a\n{ OFFSET 7 8 9 CHANNELS 3 Xposition Yposition Zposition\n"
      "JOINT b\n{ OFFSET 1 2 3 CHANNELS 3 Xposition Yposition Zposition } }\n"
      "MOTION\nFrames: 2\nFrame Time: 0.1\n";
  const auto still = value_of(read_exactly(hierarchy + "0 0 0 0 0 0\n0 0 0 0 -0 0\n"));
  EXPECT_EQ(still.clip.translation(0, 0), Eigen::Vector3d::Zero());
  EXPECT_EQ(still.clip.translation(1, 1), Eigen::Vector3d(1, 2, 3));
  ASSERT_EQ(still.warnings.size(), 1U);
  EXPECT_THAT(still.warnings[0].message, HasSubstr("the OFFSET is used for \"b\""));
  // A channel that differs from 0 by a significant part of the OFFSET is a position.
  const Clip moved = clip_of(hierarchy + "0 0 0 0 0 0\n0 0 0 0 0 0.5\n");
  EXPECT_EQ(moved.translation(0, 1), Eigen::Vector3d::Zero());
}

// A root and a chain of joints with 6 channels, with the same positions below the root in each row.
std::string chain_with_positions(const std::vector<std::string>& rows) {
  std::string text =
      "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\n";
  for (const char* name : {"Spine", "Neck", "Head"}) {
    text += std::string("JOINT ") + name +
            "\n{\nOFFSET 0 20 1\nCHANNELS 4 Xposition Yposition Zposition Yrotation\n";
  }
  text += "}\n}\n}\n}\nMOTION\nFrames: " + std::to_string(rows.size()) + "\nFrame Time: 0.1\n";
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

BvhFile read_chain(const std::vector<std::string>& rows) {
  return value_of(read_exactly(chain_with_positions(rows)));
}

TEST(ReadBvh, AddsPositionsNearZeroToTheOffset) {
  const BvhFile file = read_chain({"0 90 0  1e-6 0 -1e-6 0  0 1e-6 0 0  0 0.5 0 0",
                                   "0 90 0  1e-6 0 -1e-6 0  0 2e-6 0 0  0 0.5 0 0"});
  EXPECT_EQ(file.clip.translation(0, 1), Eigen::Vector3d(1e-6, 20, 1 - 1e-6));
  EXPECT_EQ(file.clip.translation(1, 2), Eigen::Vector3d(0, 20 + 2e-6, 1));
  EXPECT_EQ(file.clip.translation(1, 3), Eigen::Vector3d(0, 20.5, 1));
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_THAT(file.warnings[0].message, HasSubstr("near 0 compared with the OFFSET"));
  EXPECT_THAT(file.warnings[0].message, HasSubstr("\"Spine\""));
}

TEST(ReadBvh, AddsLargerPositionsIfMostAreIncrements) {
  const BvhFile file = read_chain({"0 90 0  0.01 0 0 0  0 0.01 0 0  0 4 0 0"});
  EXPECT_EQ(file.clip.translation(0, 3), Eigen::Vector3d(0, 24, 1));
}

TEST(ReadBvh, KeepsPositionsOfBoneLength) {
  // Shorter than the OFFSET, and 0 in one frame.
  const BvhFile file =
      read_chain({"0 90 0  0 12 1 0  0 11 0 0  0 10 0 0", "0 90 0  0 0 0 0  0 11 0 0  0 10 0 0"});
  EXPECT_EQ(file.clip.translation(0, 1), Eigen::Vector3d(0, 12, 1));
  EXPECT_EQ(file.clip.translation(1, 1), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(file.clip.translation(0, 3), Eigen::Vector3d(0, 10, 0));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(ReadBvh, ParsesNumbersExactly) {
  const Clip clip = clip_of(motion("2", "1e-3 2E+1 -3.5e0 0 0 0 0 0 0\n+.5 5. -.25 0 0 0 0 0 0"));
  EXPECT_EQ(clip.translation(0, 0), Eigen::Vector3d(1e-3, 20.0, -3.5));
  EXPECT_EQ(clip.translation(1, 0), Eigen::Vector3d(0.5, 5.0, -0.25));
}

TEST(ReadBvh, NamesExtendToTheEndOfTheLine) {
  const Clip clip = clip_of(
      "HIERARCHY\nROOT  mixamorig:Hips.L-x \t\n{\nOFFSET 0 0 0\nCHANNELS 0\n"
      "JOINT Bip01 Neck{ OFFSET 0 0 0 CHANNELS 0 }\r\n"
      "JOINT #1 // \xe8\x82\xa9 \r\n{ OFFSET 0 0 0 CHANNELS 1 Xrotation } }\n"
      "MOTION Frames: 1\nFrame Time: 0.5\n0");
  EXPECT_THAT(clip.skeleton().names(),
              ElementsAre("mixamorig:Hips.L-x", "Bip01 Neck", "#1 // \xe8\x82\xa9"));
}

TEST(ReadBvh, FrameTimesGiveExactRates) {
  const auto rate = [](const std::string& time) {
    return clip_of(std::string(kHierarchy) + "MOTION\nFrames: 1\nFrame Time: " + time + "\n" +
                   rows(1))
        .rate();
  };
  EXPECT_EQ(rate("0.033333"), (FrameRate{30, 1}));
  EXPECT_EQ(rate(".0083333"), (FrameRate{120, 1}));
  EXPECT_NEAR(rate("0.0417083750417").fps(), 23.976, 1e-6);
}

TEST(ReadBvh, WarnsOfAWrongFrameCount) {
  const auto file = value_of(read_exactly(motion("1", rows(2))));
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_EQ(describe(file.warnings[0], "a.bvh"),
            "a.bvh:17:9: warning: Frames declares 1, the file has 2 rows: all are read");
}

TEST(ReadBvh, RateCanBeOverridden) {
  BvhReadOptions options;
  options.source_fps = 60.0;
  const std::string start = std::string(kHierarchy) + "MOTION\nFrames: 1\n";
  for (const char* time : {"Frame Time: 0\n", "Frame Time: -1\n", "", "Frame Time: 0.0333\n"}) {
    EXPECT_EQ(clip_of(start + time + rows(1), options).rate(), (FrameRate{60, 1})) << time;
  }
  for (const double fps : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    options.source_fps = fps;
    const Result<BvhFile> file = read_exactly(motion("1", rows(1)), options);
    ASSERT_FALSE(file.has_value());
    EXPECT_EQ(file.error().kind, ErrorKind::kUsage);
  }
}

TEST(ReadBvh, WarnsAboutImplausibleRates) {
  const auto warnings = [](const std::string& time, int frames,
                           const BvhReadOptions& options = {}) {
    const std::string text = std::string(kHierarchy) + "MOTION\nFrames: " + std::to_string(frames) +
                             "\nFrame Time: " + time + "\n" + rows(frames);
    const Result<BvhFile> file = read_exactly(text, options);
    return file ? warnings_of(*file) : describe(file.error());
  };
  for (const auto& [time, said] : {std::pair{"1", "gives 1 fps and a duration of 2 s"},
                                   {"0.2", "gives 5 fps and a duration of 0.4 s"},
                                   {"1e-4", "gives 10000 fps and a duration of 0 s"}}) {
    EXPECT_THAT(warnings(time, 3), HasSubstr(said));
    EXPECT_THAT(warnings(time, 3), HasSubstr("source_fps N sets the rate"));
    EXPECT_THAT(warnings(time, 3), HasSubstr("test.bvh:18:13: warning: Frame Time"));
  }
  for (const char* time : {"0.1", "0.0333", "0.001"}) EXPECT_EQ(warnings(time, 3), "") << time;
  // The rate of a single frame does not matter.
  EXPECT_EQ(warnings("1", 1), "");
  BvhReadOptions options;
  options.source_fps = 5.0;
  EXPECT_EQ(warnings("1", 3, options), "");
}

TEST(ReadBvh, CanChooseOneOfSeveralRoots) {
  const std::string text =
      "HIERARCHY ROOT a\n{ OFFSET 0 0 0 CHANNELS 1 Xposition }\n"
      "ROOT b\n{ OFFSET 0 0 0 CHANNELS 1 Xposition JOINT c { OFFSET 0 0 0 CHANNELS 1 Xrotation } "
      "}\n"
      "ROOT a\n{ OFFSET 0 0 0 CHANNELS 1 Xposition }\n"
      "MOTION\nFrames: 2\nFrame Time: 1\n1 2 0 3\n4 5 0 6\n";
  BvhReadOptions options;
  options.root = "b";
  const Clip clip = clip_of(text, options);
  EXPECT_THAT(clip.skeleton().names(), ElementsAre("b", "c"));
  EXPECT_EQ(clip.skeleton().joint(1).parent, 0);
  EXPECT_THAT(first_values(clip), ElementsAre(2, 5));
  options.root = "B";
  EXPECT_THAT(error_of(text, options), HasSubstr("found a, b, a"));
  options.root = "a";
  EXPECT_THAT(error_of(text, options), HasSubstr("found several"));
}

TEST(ReadBvh, CanReadOnlyTheSkeleton) {
  EXPECT_THAT(error_of(kHierarchy), HasSubstr("test.bvh:16:1: error: expected MOTION"));
  BvhReadOptions options;
  options.motion_optional = true;
  const auto file = value_of(read_exactly(kHierarchy, options));
  EXPECT_EQ(file.clip.frame_count(), 0);
  // The available part of MOTION is still checked.
  EXPECT_FALSE(read_exactly(std::string(kHierarchy) + "MOTION\n", options).has_value());
  EXPECT_FALSE(read_exactly(motion("3", ""), options).has_value());
}

// Arrangements of rows on lines.

TEST(ReadBvh, AcceptsWrappedAndSharedLines) {
  const Clip plain = clip_of(motion("4",
                                    "0 2 3 10 20 30 40 50 60\n1 2 3 10 20 30 40 50 60\n"
                                    "2 2 3 10 20 30 40 50 60\n3 2 3 10 20 30 40 50 60\n"));
  for (const char* data :
       {// wrapped alike, wrapped unevenly, shared
        "0 2 3 10 20\n30 40 50 60\n1 2 3 10 20\n30 40 50 60\n2 2 3 10 20\n30 40 50 60\n"
        "3 2 3 10 20\n30 40 50 60\n",
        "0 2 3 10 20 30 40 50 60\n1\n2 3 10 20 30 40\n50 60\n2 2 3 10 20 30 40 50 60\n\n"
        "3 2 3 10 20 30 40 50 60",
        "0 2 3 10 20 30 40 50 60 1 2 3 10 20 30 40 50 60\r2 2 3 10 20 30 40 50 60 3 2 3 10 20 "
        "30 40 50 60",
        // Twelve values per line, independent of the rows.
        "0 2 3 10 20 30 40 50 60 1 2 3\n10 20 30 40 50 60 2 2 3 10 20 30\n"
        "40 50 60 3 2 3 10 20 30 40 50 60\n"}) {
    SCOPED_TRACE(data);
    expect_same_motion(clip_of(motion("4", data)), plain);
  }
}

TEST(ReadBvh, NeverShiftsColumns) {
  // One value too many and one too few: the total is correct.
  EXPECT_THAT(error_of(motion("4", row(0) + "1 2 3 10 20 30 40 50 60 70\n" +
                                       "2 3 10 20 30 40 50 60\n" + row(3))),
              HasSubstr(":20:1: error: expected rows of 9 values, one per channel of HIERARCHY, "
                        "found 10 on this line"));
  EXPECT_THAT(error_of(motion("4", row(0) + "1 2 3 10 20 30 40 50\n" +
                                       "2 2 3 10 20 30 40 50 60 70\n" + row(3))),
              HasSubstr(":20:1: error: expected rows of 9 values"));
  // For a stream, nine lines of ten values are ten rows of nine.
  std::string tens;
  for (int i = 0; i < 9; ++i) tens += "0 1 2 3 4 5 6 7 8 9\n";
  for (const char* frames : {"9", "5"}) {
    EXPECT_THAT(error_of(motion(frames, tens)), HasSubstr(":19:1: error: expected rows of 9"));
  }
  EXPECT_THAT(error_of(motion("2", "1 2 3 10 20 30.0-7.5 50 60 1\n" + row(1))),
              HasSubstr(":19:13: error: expected a number followed by white space (value 6 of 9 in "
                        "row 1 of 2), found \"30.0-7.5\"\n  hint: a space is missing before"));
}

TEST(ReadBvh, CountsLinesForAllLineEndings) {
  std::string text = motion("2", row(0) + "1 2 x\n");
  EXPECT_THAT(error_of(text), HasSubstr(":20:5: "));
  std::string cr, crlf, mixed;
  for (const char c : text) {
    cr += c == '\n' ? "\r" : std::string(1, c);
    crlf += c == '\n' ? "\r\n" : std::string(1, c);
    mixed += c != '\n' ? std::string(1, c) : mixed.size() % 3 == 0 ? "\r" : "\r\n";
  }
  EXPECT_THAT(error_of(cr), HasSubstr(":20:5: "));
  EXPECT_THAT(error_of(crlf), HasSubstr(":20:5: "));
  EXPECT_THAT(error_of(mixed), HasSubstr(":20:5: "));
}

// Oddities that pass with a warning.

TEST(ReadBvh, WarnsOncePerKindInOrder) {
  const auto file = value_of(read_exactly(
      "HIERARCHY\n# one\nROOT a\n{\nOFFSET 0 0 0 1 2 3\n// two\nCHANNELS 2 Xscale Xrotation\n"
      "JOINT b\n{\nOFFSET 0 0 0 9\n}\nJOINT b\n{\nOFFSET 0 0 0\nCHANNELS 0\n"
      "End Site\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\n}\n}\n"
      "MOTION\n# three\nFrames: 1\nFrame Time: 0.04\n# four\n1 0 # five\n1 90\n\nFOOT 1 2\n"));
  EXPECT_EQ(
      warnings_of(file),
      "test.bvh:2:1: warning: comment lines skipped\n"
      "test.bvh:5:14: warning: 2 OFFSETs with more than three numbers: the first three are used\n"
      "test.bvh:7:12: warning: 1 scale channel ignored\n"
      "test.bvh:8:7: warning: 1 joint without CHANNELS: read as CHANNELS 0\n"
      "test.bvh:12:7: warning: several joints have the same name: \"b\"; only their positions "
      "in the file distinguish them\n"
      "test.bvh:19:1: warning: 1 End Site with CHANNELS: ignored\n"
      "test.bvh:25:9: warning: Frames declares 1, the file has 2 rows: all are read\n"
      "test.bvh:31:1: warning: text after the last frame ignored: \"FOOT\" and the "
      "rest\n");
  EXPECT_EQ(file.clip.frame_count(), 2);
}

// Rejections.

TEST(ReadBvh, HierarchyErrorsHaveALocation) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"OFFSET 0 0 0\nOFFSET 0 0 0", ":5:1: error: expected one OFFSET in joint \"Hips\", found"},
      {"CHANNELS 0\nCHANNELS 0", ":5:1: error: expected one CHANNELS"},
      {"CHANNELS 0", ":5:1: error: expected OFFSET before the end of joint \"Hips\" (line 2)"},
      {"OFFSET 0 0 0\nCHANNELS x", ":5:10: error: expected the channel count"},
      {"OFFSET 0 0 0\nCHANNELS -1", ":5:10: error: expected the channel count"},
      {"OFFSET 0 0 0\nCHANNELS 1 Xpos", ":5:12: error: expected channel 1 of the 1 of joint"},
      {"CHANNELS 1 Xrotation Yrotation", "hint: CHANNELS lists more names than its count"},
      {"CHANNELS 2 Xposition xposition", ":4:22: error: expected each position channel once"},
      {"OFFSET 0 0 1,5", "with a decimal comma"},
      {"OFFSET 0 0 1e999", ":4:12: error: expected a number within the range of double"},
      {"OFFSET 0 0 nan", "expected a finite number"},
      {"OFFSETS 0 0 0", "found \"OFFSETS\" (did you mean \"OFFSET\"?)"},
      {"JOINT\n{", ":5:1: error: expected a joint name, found \"{\""},
      {"JOINT a\x01z\n{", "found a control character in \"a\\x01z\""},
      {"JOINT a\nOFFSET 0 0 0", ":5:1: error: expected '{' after joint \"a\", found \"OFFSET\""},
      {"JOINT a { OFFSET 0 0 0 }\nCHANNELS 0", "before its child joints"},
      {"End a", ":4:5: error: expected Site after End, found \"a\""},
      {"End Site { JOINT a", "expected OFFSET or '}' in an End Site, found \"JOINT\""},
      {"End Site { }", "expected OFFSET before the end of the End Site of \"Hips\""},
      {"End Site { OFFSET 0 0 0 CHANNELS 1 Xrotation }", "expected no channels in an End Site"},
      {"ROOT b", "expected OFFSET, CHANNELS, JOINT, End Site or '}' in joint \"Hips\", found "},
      {std::string("\0", 1),
       ":4:1: error: expected OFFSET, CHANNELS, JOINT, End Site or '}' in "
       "joint \"Hips\", found a NUL byte"},
  };
  for (const auto& [inside, message] : faults) {
    EXPECT_THAT(error_of(root(inside)), HasSubstr(message));
  }
}

TEST(ReadBvh, MotionHeaderErrorsHaveALocation) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"", ":17:1: error: expected Frames: and a count, found the end of the file"},
      {"1 2 3", ":17:1: error: expected Frames: and a count, found \"1\""},
      {"Frames:\n2",
       ":17:8: error: expected the frame count, a whole number, found the end "
       "of the line"},
      {"Frames: 99999999999999999999", ":17:9: error: expected the frame count"},
      {"Frames: 1\nFrame Rate: 30", ":18:7: error: expected Time: after Frame, found \"Rate:\""},
      {"Frames: 1\nFrame Time:\n1 2 3",
       ":18:12: error: expected a number (the frame time in "
       "seconds), found the end of the line"},
      {"Frames: 1\nFrame Time: 0,04", "found \"0,04\" with a decimal comma"},
      {"Frames: 1\nFrame Time: nan", "expected a finite number (the frame time in seconds)"},
      {"Frames: 1\nFrame Time: 0.1s", "found \"0.1s\""},
  };
  for (const auto& [header, message] : faults) {
    EXPECT_THAT(error_of(std::string(kHierarchy) + "MOTION\n" + header), HasSubstr(message));
  }
  const std::string rigid = root("OFFSET 0 0 0\nCHANNELS 0");
  EXPECT_TRUE(read_exactly(rigid).has_value());
  EXPECT_THAT(error_of(std::string(rigid).replace(rigid.find("Frames: 0"), 9, "Frames: 2")),
              HasSubstr("expected no frames, because no joint has a channel, found \"2\""));
}

TEST(ReadBvh, RowErrorsHaveALocation) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {row(0),
       ":20:1: error: expected 2 rows, as declared by Frames on line 17, found 1 before the end "
       "of the file\n  hint: the file seems to be truncated; lenient keeps"},
      {row(0) + "1 2 3 10", ":20:1: error: expected 9 values in row 2, which begins here, found 4"},
      {row(0) + "1 2 -inf",
       ":20:5: error: expected a finite number (value 3 of 9 in row 2 of 2), "
       "found \"-inf\"\n  hint: lenient"},
      {row(0) + "1 -1.#IND 2", "expected a finite number"},
      {row(0) + "1 2 1e400", ":20:5: error: expected a number within the range of double"},
      {row(0) + "1.0,2.0,3.0", "hint: separate the values with spaces"},
      {row(0) + "FOOTPLANT",
       ":20:1: error: expected a number (value 1 of 9 in row 2 of 2), found "
       "\"FOOTPLANT\""},
      {row(0) + row(1) + "nan 2 3", ":21:1: error: expected a finite number"},
      {row(0) + row(1) + std::string("\0\0", 2), "found a NUL byte\n  hint: the file is damaged"},
      {row(0) + row(1) + "1 2 x", ":21:5: error: expected a number (value 3 of 9 in row 3), found"},
  };
  for (const auto& [data, message] : faults) {
    EXPECT_THAT(error_of(motion("2", data)), HasSubstr(message));
  }
}

TEST(ReadBvh, RecognisesFilesThatAreNotBvh) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"\n <!DOCTYPE HTML><p>", "found a web page"},
      {"version https://git-lfs.github.com/spec/v1\noid", "found a git-LFS pointer"},
      {"\x1f\x8b\x08", "found a gzip archive"},
      {"PK\x03\x04zz", "found a ZIP archive"},
      {"Kaydara FBX Binary  ", "found a binary FBX file"},
      {"\xfe\xff\0H", "found UTF-16 text"},
      {std::string("H\0I\0E\0", 6), "found UTF-16 text"},
      {"hello", "expected HIERARCHY, found \"hello\""},
      {" \n\t\n", ":3:1: error: expected HIERARCHY, found the end of the file"},
      {"\xef\xbb\xbf", "found an empty file"},
      {"\x80\xff\x01", "found \"\\x80\\xff\\x01\""},
      {"HIERARCHY\nJOINT a", ":2:1: error: expected ROOT and a name, found \"JOINT\""},
  };
  for (const auto& [bytes, message] : files) EXPECT_THAT(error_of(bytes), HasSubstr(message));
}

TEST(ReadBvh, UnreadableFilesAreErrors) {
  EXPECT_EQ(load_bvh("/no/such/file.bvh").error().kind, ErrorKind::kInput);
  EXPECT_EQ(load_bvh(testing::TempDir()).error().kind, ErrorKind::kInput);
}

// Damaged files.

TEST(ReadBvh, LenientSkipsDamagedLines) {
  for (const char* bad : {"9 2 3 nan 20 30 40 50 60\n", "9 2 3 10 20 30 40 50\n", "x\n",
                          "9 2 3 10 20 30 40 50 60 70\n", "9 2 3 10 2x0 30 40 50 60\n"}) {
    const auto file =
        value_of(read_exactly(motion("5", row(0) + row(1) + bad + row(3) + row(4)), lenient()));
    EXPECT_THAT(first_values(file.clip), ElementsAre(0, 1, 3, 4)) << bad;
    ASSERT_EQ(file.warnings.size(), 1U);
    EXPECT_EQ(file.warnings[0].line, 21U);
    EXPECT_THAT(
        file.warnings[0].message,
        HasSubstr(
            ": kept 4 of 5 declared rows; dropped 1 damaged line, later frames come earlier"));
  }
}

TEST(ReadBvh, LenientResynchronisesAfterAShift) {
  const auto file = value_of(read_exactly(
      motion("4", row(0) + "1 2 3 10 20 30 40 50 60 70\n" + "2 3 10 20 30 40 50 60\n" + row(3)),
      lenient()));
  EXPECT_THAT(first_values(file.clip), ElementsAre(0, 3));
  EXPECT_THAT(warnings_of(file), HasSubstr("dropped 2 damaged lines"));
}

TEST(ReadBvh, LenientKeepsCompleteFramesOfWrappedRows) {
  const std::string wrapped = "0 2 3 10 20\n30 40 50 60\n1 2 3 10 20\n30 40 50 60\n";
  const auto file = value_of(
      read_exactly(motion("4", wrapped + "2 2 nan 10 20\n30 40 50 60\n" + wrapped), lenient()));
  EXPECT_THAT(first_values(file.clip), ElementsAre(0, 1));
  EXPECT_THAT(warnings_of(file), HasSubstr("the rest of the file was dropped"));

  const auto shared = value_of(read_exactly(
      motion("4", "0 2 3 10 20 30 40 50 60 1 2 3 10 20 30 40 50 60 2 2 nan"), lenient()));
  EXPECT_THAT(first_values(shared.clip), ElementsAre(0, 1));
}

TEST(ReadBvh, LenientWarnsAndNeedsACompleteFrame) {
  const auto few = value_of(read_exactly(motion("5", rows(3)), lenient()));
  EXPECT_THAT(warnings_of(few), HasSubstr("found 3 before the end of the file: kept 3 of 5"));
  EXPECT_FALSE(read_exactly(motion("5", ""), lenient()).has_value());
  EXPECT_FALSE(read_exactly(motion("1", "1 2 3"), lenient()).has_value());
  EXPECT_FALSE(read_exactly(motion("x", rows(3)), lenient()).has_value());
  // A valid file causes no warning.
  const auto good = value_of(read_exactly(motion("2", rows(2)), lenient()));
  EXPECT_TRUE(good.warnings.empty());
}

}  // namespace
}  // namespace retarget
