#include "retarget/clip_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace retarget {
namespace {

using ::testing::HasSubstr;

constexpr FrameRate k30{30, 1};

TEST(FrameRangeFromText, IsHalfOpenAndCountsFromZero) {
  EXPECT_EQ(frame_range_from_text("10:20", 100).value(), (FrameRange{10, 20}));
  EXPECT_EQ(frame_range_from_text("0:1", 100).value(), (FrameRange{0, 1}));
  EXPECT_EQ(frame_range_from_text("99:100", 100).value(), (FrameRange{99, 100}));
}

TEST(FrameRangeFromText, MissingBoundsDefaultToTheClip) {
  EXPECT_EQ(frame_range_from_text(":", 100).value(), (FrameRange{0, 100}));
  EXPECT_EQ(frame_range_from_text("7:", 100).value(), (FrameRange{7, 100}));
  EXPECT_EQ(frame_range_from_text(":7", 100).value(), (FrameRange{0, 7}));
}

TEST(FrameRangeFromText, ClampsToTheEndOfTheClip) {
  EXPECT_EQ(frame_range_from_text("0:300", 100).value(), (FrameRange{0, 100}));
  EXPECT_EQ(frame_range_from_text("0:99999999999999999999", 100).value(), (FrameRange{0, 100}));
}

TEST(FrameRangeFromText, InvalidTextIsAUsageError) {
  for (const std::string text :
       {"", "5", "a:b", "-1:5", "1:-5", "+1:5", " 1:5", "1:5 ", "1:2:3", "1.5:3", "0x1:5", "1,5"}) {
    const auto range = frame_range_from_text(text, 100);
    ASSERT_FALSE(range.has_value()) << text;
    EXPECT_EQ(range.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(range.error().message, HasSubstr("\"" + text + "\" does not have the form a:b"));
  }
}

TEST(FrameRangeFromText, RangesWithoutFramesAreUsageErrors) {
  for (const std::string text : {"5:5", "6:5", "0:0", ":0"}) {
    const auto range = frame_range_from_text(text, 100);
    ASSERT_FALSE(range.has_value()) << text;
    EXPECT_THAT(range.error().message, HasSubstr("contains no frames"));
  }
  for (const std::string text : {"100:200", "100:", "99999999999999999999:"}) {
    const auto range = frame_range_from_text(text, 100);
    ASSERT_FALSE(range.has_value()) << text;
    EXPECT_THAT(range.error().message,
                HasSubstr("after the end of the clip, which has frames 0 to 99"));
  }
  EXPECT_FALSE(frame_range_from_text(":", 0).has_value());
}

TEST(FrameRangeFromSeconds, BothEndsAreInclusive) {
  EXPECT_EQ(frame_range_from_seconds(1.0, 2.0, k30, 301).value(), (FrameRange{30, 61}));
  EXPECT_EQ(frame_range_from_seconds(1.01, 1.99, k30, 301).value(), (FrameRange{31, 60}));
  EXPECT_EQ(frame_range_from_seconds(0.5, 0.5, k30, 301).value(), (FrameRange{15, 16}));
  EXPECT_EQ(frame_range_from_seconds(0.0, 0.0, k30, 301).value(), (FrameRange{0, 1}));
}

// In doubles, 0.1 * 30 is slightly above 3, 0.3 * 30 is exactly 9, and 0.7 / 30 is inexact.
TEST(FrameRangeFromSeconds, DecimalTimesSnapToFrames) {
  for (int frame = 0; frame <= 3000; ++frame) {
    const double time = frame / 30.0;
    EXPECT_EQ(frame_range_from_seconds(time, time, k30, 3001).value(),
              (FrameRange{frame, frame + 1}));
    const double typed = std::stod(std::to_string(frame / 10.0));
    EXPECT_EQ(frame_range_from_seconds(typed, {}, k30, 9001).value().begin, 3 * frame);
    EXPECT_EQ(frame_range_from_seconds({}, typed, k30, 9001).value().end, 3 * frame + 1);
  }
}

TEST(FrameRangeFromSeconds, MissingTimesDefaultToTheClip) {
  EXPECT_EQ(frame_range_from_seconds({}, {}, k30, 301).value(), (FrameRange{0, 301}));
  EXPECT_EQ(frame_range_from_seconds({}, {}, k30, 0).value(), (FrameRange{0, 0}));
  EXPECT_EQ(frame_range_from_seconds(9.9, {}, k30, 301).value(), (FrameRange{297, 301}));
  EXPECT_EQ(frame_range_from_seconds({}, 0.05, k30, 301).value(), (FrameRange{0, 2}));
  EXPECT_EQ(frame_range_from_seconds({}, 1e300, k30, 301).value(), (FrameRange{0, 301}));
  EXPECT_EQ(frame_range_from_seconds(1.0, 2.0, FrameRate{2997, 125}, 301).value(),
            (FrameRange{24, 48}));
}

TEST(FrameRangeFromSeconds, ImpossibleTimesAreUsageErrors) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, kNan, kInfinity, -kInfinity}) {
    for (const auto& range : {frame_range_from_seconds(bad, {}, k30, 301),
                              frame_range_from_seconds({}, bad, k30, 301)}) {
      ASSERT_FALSE(range.has_value()) << bad;
      EXPECT_EQ(range.error().kind, ErrorKind::kUsage);
      EXPECT_THAT(range.error().message, HasSubstr("is not a valid time"));
    }
  }
}

TEST(FrameRangeFromSeconds, RangesWithoutFramesAreUsageErrors) {
  const auto message = [](std::optional<double> start, std::optional<double> end, int count) {
    const auto range = frame_range_from_seconds(start, end, k30, count);
    return range.has_value() ? std::string() : describe(range.error());
  };
  EXPECT_EQ(message(2.0, 1.0, 301), "error: the end at 1 s comes before the start at 2 s");
  EXPECT_EQ(message(0.101, 0.102, 301), "error: no frame lies between 0.101 s and 0.102 s");
  EXPECT_EQ(message(10.1, {}, 301),
            "error: the start at 10.1 s is after the end of the clip, which ends at 10 s");
  EXPECT_EQ(message(1e300, {}, 301),
            "error: the start at 1e+300 s is after the end of the clip, which ends at 10 s");
  EXPECT_EQ(message(0.0, {}, 0),
            "error: the start at 0 s is after the end of the clip, which has no frames");
}

TEST(RangeDoubts, NameThePartBeyondTheClip) {
  const auto doubts = [](const PartOptions& part) { return range_doubts(part, k30, 301); };
  PartOptions part;
  for (const char* frames : {"", ":", "290:", "0:300", "0:301", "0:302"}) {
    part.frames = frames;
    EXPECT_TRUE(doubts(part).empty()) << frames;
  }
  for (const char* frames : {"290:4000", "0:303", ":99999999999999999999"}) {
    part.frames = frames;
    ASSERT_EQ(doubts(part).size(), 1U) << frames;
    EXPECT_THAT(doubts(part)[0].message,
                HasSubstr("ends after the clip, which has frames 0 to 300"));
  }
  part.frames.clear();
  for (const double end : {-1.0, 0.0, 10.0, 10.03}) {
    part.end_s = end;
    EXPECT_TRUE(doubts(part).empty()) << end;
  }
  part.end_s = 60.0;
  ASSERT_EQ(doubts(part).size(), 1U);
  EXPECT_EQ(doubts(part)[0].message,
            "the end at 60 s is after the clip, which ends at 10 s: the part is cut there");
}

}  // namespace
}  // namespace retarget
