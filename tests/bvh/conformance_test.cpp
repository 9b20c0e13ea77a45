// The verdicts of conformance/expected.tsv and of the quirk collection, file by file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "base/option_name.h"
#include "bvh_test_support.h"
#include "formats/bvh/read_bvh.h"
#include "support/shared_data.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::filesystem::path conformance_folder() {
  return std::filesystem::path(RETARGET_SOURCE_DIR) / "tests/bvh/conformance";
}

std::string conformance_file(const std::string& name) {
  return file_text(conformance_folder() / (name + ".bvh"));
}

// Every rejection states expected and found values with a location.
void expect_good_rejection(const Error& error, const std::string& name) {
  EXPECT_EQ(error.kind, ErrorKind::kInput) << name;
  EXPECT_GE(error.location.line, 1U) << name;
  EXPECT_GE(error.location.column, 1U) << name;
  EXPECT_THAT(error.message, StartsWith("expected ")) << name;
  EXPECT_THAT(error.message, HasSubstr(", found ")) << name;
  EXPECT_THAT(describe(error), StartsWith("test.bvh:" + std::to_string(error.location.line) + ":" +
                                          std::to_string(error.location.column) + ": error: "));
}

TEST(Conformance, VerdictsMatchTheTable) {
  const auto rows = table_rows(conformance_folder() / "expected.tsv");
  EXPECT_EQ(rows.size(), 64U);
  for (const auto& row : rows) {
    ASSERT_GE(row.size(), 5U);
    const std::string& name = row[0];
    const std::string& verdict = row[1];
    const Result<BvhFile> file = read_exactly(conformance_file(name));
    if (verdict == "error") {
      ASSERT_FALSE(file.has_value()) << name;
      expect_good_rejection(file.error(), name);
      continue;
    }
    ASSERT_TRUE(file.has_value()) << name << ": " << describe(file.error());
    EXPECT_EQ(!file->warnings.empty(), verdict == "ok+warn") << name << "\n" << warnings_of(*file);
    EXPECT_EQ(std::to_string(file->clip.skeleton().joint_count()), row[2]) << name;
    EXPECT_EQ(std::to_string(file->clip.frame_count()), row[3]) << name;
    EXPECT_EQ(std::to_string(file->clip.skeleton().channel_count()), row[4]) << name;
  }
}

TEST(Conformance, SameNumbersGiveTheSameMotion) {
  const Clip base = clip_of(conformance_file("base"));
  EXPECT_EQ(base.rate(), (FrameRate{30, 1}));
  for (const char* name :
       {"crlf",           "cr",           "bom",       "brace_same_line", "ch_before_off",
        "space_name",     "colon_name",   "utf8_name", "lower",           "lowerj",
        "endname",        "endupper",     "tab_dot",   "frames_nospace",  "no_eol",
        "trailing_blank", "wrapped_row",  "childless", "dupname",         "comment",
        "frames_too_few", "end_channels", "two_ends",  "trailing_junk",   "capital_x_lower",
        "blank_before"}) {
    SCOPED_TRACE(name);
    const Clip clip = clip_of(conformance_file(name));
    expect_same_motion(clip, base);
    EXPECT_EQ(clip.rate(), base.rate());
  }
}

TEST(Conformance, RejectionsNameErrorAndPosition) {
  const std::map<std::string, std::pair<std::string, std::string>> expected = {
      {"frames_too_many", {"21:1", "expected 3 rows, as declared by Frames on line 17, found 2"}},
      {"short_row", {"19:1", "expected rows of 9 values"}},
      {"long_row", {"19:1", "found 10 on this line"}},
      {"badtok", {"10:3", "found \"XEnd\" (did you mean \"End\"?)"}},
      {"comma_dec", {"19:1", "\"1,5\" with a decimal comma"}},
      {"nan", {"19:1", "expected a finite number (value 1 of 9 in row 1 of 2), found \"nan\""}},
      {"zero_ft", {"18:13", "expected a frame time above 0 seconds, found \"0\""}},
      {"no_ft", {"18:1", "expected Frame Time: and seconds, found \"1\""}},
      {"two_roots", {"16:1", "found a second: \"Two\" after \"Hips\" on line 2"}},
      {"empty", {"1:1", "expected HIERARCHY, found an empty file"}},
      {"badnum", {"19:10", "found \"2x0\""}},
      {"unbalanced", {"15:1", "expected '}' to close joint \"Hips\" of line 2, found \"MOTION\""}},
      {"extra_close", {"16:1", "expected MOTION after the skeleton, found \"}\""}},
      {"no_motion", {"16:1", "found the end of the file"}},
      {"no_hierarchy", {"1:1", "expected HIERARCHY, found \"ROOT\""}},
      {"unknown_channel", {"9:14", "found \"Wrotation\" (did you mean \"Xrotation\"?)"}},
      {"chan_count_lie", {"10:3", "expected channel 4 of the 4 of joint \"A\", found \"End\""}},
      {"huge_frames", {"21:1", "expected 2000000000 rows"}},
      {"neg_frames", {"17:9", "a whole number, found \"-2\""}},
      {"float_frames", {"17:9", "found \"2.0\""}},
      {"neg_ft", {"18:13", "found \"-0.033333\""}},
      {"off_two",
       {"9:3", "expected a number (number 3 of 3 of OFFSET in joint \"A\"), found \"CHA"}},
      {"zero_byte", {"20:1", "found a NUL byte"}},
      {"utf16", {"1:1", "found UTF-16 text"}},
  };
  for (const auto& [name, place_and_text] : expected) {
    const Result<BvhFile> file = read_exactly(conformance_file(name));
    ASSERT_FALSE(file.has_value()) << name;
    const Error& error = file.error();
    EXPECT_EQ(std::to_string(error.location.line) + ":" + std::to_string(error.location.column),
              place_and_text.first)
        << describe(error);
    EXPECT_THAT(error.message, HasSubstr(place_and_text.second)) << name;
  }
}

// Quirk files.

struct Quirk {
  std::string name;
  std::string text;
  std::string verdict;
};

class Quirks : public testing::Test {
 protected:
  void SetUp() override {
    const auto shared = shared_folder();
    if (!shared) GTEST_SKIP() << kNoSharedFolder;
    const std::filesystem::path folder = *shared / "data/quirks";
    for (const auto& row : table_rows(folder / "README.tsv")) {
      const std::string text = file_text(folder / row.at(0));
      quirks_[row.at(0)] = {row.at(0), text, row.at(3)};
    }
    ASSERT_EQ(quirks_.size(), 45U);
  }

  // Looked up by the number at the start of a quirk's name.
  const std::string& text(const std::string& number) const {
    for (const auto& [name, quirk] : quirks_) {
      if (name.starts_with(number + "_")) return quirk.text;
    }
    ADD_FAILURE() << "no quirk " << number;
    return quirks_.begin()->second.text;
  }

  std::map<std::string, Quirk> quirks_;
};

// If the table allows both, the conformance table decides.
const std::set<std::string> kRejected = {"02", "05", "11", "13", "15", "16", "24", "25",
                                         "26", "27", "36", "38", "39", "40", "41", "42"};
const std::set<std::string> kWarned = {"10", "14", "20", "28", "37"};

TEST_F(Quirks, VerdictsMatchTheTable) {
  for (const auto& [name, quirk] : quirks_) {
    const std::string number = name.substr(0, 2);
    const Result<BvhFile> file = read_exactly(quirk.text);
    EXPECT_EQ(file.has_value(), !kRejected.contains(number)) << name;
    if (!file) {
      EXPECT_THAT(quirk.verdict, HasSubstr("reject")) << name;
      expect_good_rejection(file.error(), name);
      continue;
    }
    EXPECT_THAT(quirk.verdict, testing::AnyOf(HasSubstr("accept"), HasSubstr("hierarchy readable"),
                                              HasSubstr("disambiguate")))
        << name;
    EXPECT_EQ(!file->warnings.empty(), kWarned.contains(number)) << name << warnings_of(*file);
    EXPECT_EQ(file->clip.skeleton().joint_count(), 18) << name;
    EXPECT_EQ(file->clip.frame_count(), number == "10" ? 0 : 2) << name;
  }
}

TEST_F(Quirks, AcceptedFilesMatchTheReferenceMotion) {
  const Clip reference = clip_of(text("00"));
  for (const char* number :
       {"01", "03", "04", "06", "07", "08", "09", "12", "14", "17", "18", "19",
        "20", "28", "29", "30", "31", "32", "33", "34", "35", "37", "43", "44"}) {
    SCOPED_TRACE(number);
    expect_same_motion(clip_of(text(number)), reference);
  }
}

TEST_F(Quirks, RejectionsHaveHints) {
  const std::map<std::string, std::pair<std::string, std::string>> expected = {
      {"02", {"UTF-16", "UTF-8"}},
      {"05", {"found \"88.36-3.41\"", "a space is missing before \"-3.41\""}},
      {"13", {"decimal comma", ""}},
      {"16", {"57 values in row 2", OPTION("lenient")}},
      {"25", {"found \"nan\"", OPTION("lenient")}},
      {"27", {"\"Prop\" after \"Hips\"", OPTION("root") " NAME"}},
      {"36", {"OFFSET", ""}},
      {"38", {"a git-LFS pointer", "git lfs pull"}},
      {"40", {"a web page", "raw file"}},
      {"11", {"frame time", OPTION("source-fps")}},
  };
  for (const auto& [number, message_and_hint] : expected) {
    const Result<BvhFile> file = read_exactly(text(number));
    ASSERT_FALSE(file.has_value()) << number;
    EXPECT_THAT(file.error().message, HasSubstr(message_and_hint.first)) << number;
    EXPECT_THAT(file.error().hint, HasSubstr(message_and_hint.second)) << number;
  }
}

TEST_F(Quirks, KeepsFullNames) {
  EXPECT_TRUE(clip_of(text("06")).skeleton().find("Bip01 Neck"));
  EXPECT_TRUE(clip_of(text("07")).skeleton().find("mixamorig:Hips.L-x"));
}

TEST_F(Quirks, OptionsAcceptTheirFiles) {
  const Clip reference = clip_of(text("00"));
  // The rate comes from the options.
  BvhReadOptions rate;
  rate.source_fps = 120.0;
  for (const char* number : {"11", "12"}) {
    const Clip clip = clip_of(text(number), rate);
    EXPECT_EQ(clip.rate(), (FrameRate{120, 1}));
    expect_same_motion(clip, reference);
  }
  // Reads one of two trees.
  BvhReadOptions hips;
  hips.root = "Hips";
  expect_same_motion(clip_of(text("27"), hips), reference);
  BvhReadOptions prop;
  prop.root = "Prop";
  const auto second = value_of(read_exactly(text("27"), prop));
  EXPECT_EQ(second.clip.skeleton().joint_count(), 1);
  // Reads only the skeleton.
  BvhReadOptions skeleton;
  skeleton.motion_optional = true;
  const auto alone = value_of(read_exactly(text("41"), skeleton));
  EXPECT_EQ(alone.clip.frame_count(), 0);
  EXPECT_EQ(alone.clip.skeleton().joint_count(), 18);
  EXPECT_FALSE(read_exactly(text("42"), skeleton).has_value());
}

TEST_F(Quirks, LenientKeepsCompleteRows) {
  BvhReadOptions lenient;
  lenient.lenient = true;
  const Clip reference = clip_of(text("00"));
  const Clip first = cut(reference, 0, 1);
  for (const char* number : {"16", "25"}) {
    SCOPED_TRACE(number);
    const auto file = value_of(read_exactly(text(number), lenient));
    expect_same_motion(file.clip, first);
    EXPECT_THAT(warnings_of(file), HasSubstr("kept 1 of 2 declared rows"));
  }
  const auto more = value_of(read_exactly(text("15"), lenient));
  expect_same_motion(more.clip, reference);
  EXPECT_THAT(warnings_of(more), HasSubstr("kept 2 of 5 declared rows"));
  // No complete row remains.
  for (const char* number : {"05", "13", "42"}) {
    EXPECT_FALSE(read_exactly(text(number), lenient).has_value()) << number;
  }
}

}  // namespace
}  // namespace retarget
