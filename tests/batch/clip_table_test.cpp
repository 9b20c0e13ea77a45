#include "batch/input_variants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

BatchInput input_at(const std::string& relative) {
  return {"in/" + relative, relative, 100, 0, {}, {}};
}

class ClipTableTest : public ::testing::Test {
 protected:
  Result<std::vector<ClipRow>> read(const std::string& text) {
    path_ = folder_.write("parts.csv", text);
    return read_clip_table(path_);
  }
  // The error message after the folder's name.
  std::string error_of(const std::string& text) {
    const auto rows = read(text);
    if (rows) return "no error";
    const std::string said = describe(rows.error());
    return said.substr(said.find("parts.csv"));
  }
  Result<std::vector<BatchInput>> parts(const std::string& text) {
    const auto rows = read(text);
    return parts_of(inputs_, rows.value(), path_);
  }

  TemporaryFolder folder_;
  std::string path_;
  std::vector<BatchInput> inputs_ = {input_at("a/walk.bvh"), input_at("b/walk.bvh"),
                                     input_at("b/run.npz")};
};

TEST_F(ClipTableTest, ReadsRowsWithAndWithoutAHeader) {
  for (const char* text : {"a/walk.bvh,1.5,3,kick\nb/run.npz,f10,f20,\n",
                           "file,start,end,name\na/walk.bvh,1.5,3,kick\n"
                           "\n# both\nb/run.npz,f10,f20\n",
                           "\xEF\xBB\xBFname;end;more;FILE;start\r\nkick;3;x;\"a/walk.bvh\";1.5\r\n"
                           ";f20;;b/run.npz;f10\r\n"}) {
    const auto rows = read(text).value();
    ASSERT_EQ(rows.size(), 2U) << text;
    EXPECT_EQ(rows[0].file, "a/walk.bvh");
    EXPECT_EQ(rows[0].part, "1.5:3");
    EXPECT_EQ(rows[0].name, "kick");
    EXPECT_EQ(rows[1].part, "f10:f20");
    EXPECT_EQ(rows[1].name, "");
  }
}

TEST_F(ClipTableTest, ErrorsNameTheLine) {
  EXPECT_THAT(error_of("a,1,2\nb,one,2\n"), StartsWith("parts.csv:2: error: expected a time or a"));
  EXPECT_THAT(error_of("file,start,end\na,f1,2\n"), StartsWith("parts.csv:2: error: f1 and 2"));
  EXPECT_THAT(error_of("a,3,2\n"), HasSubstr("from 3 to 2 is empty"));
  EXPECT_THAT(error_of("a,f5,f5\n"), HasSubstr("is empty"));
  EXPECT_THAT(error_of("a,-1,2\n"), HasSubstr("\"-1\""));
  EXPECT_THAT(error_of("a,nan,2\n"), HasSubstr("\"nan\""));
  EXPECT_THAT(error_of("a,1,2,../up\n"), HasSubstr("\"../up\" is not a valid clip name"));
  EXPECT_THAT(error_of("a,1,2,/root\n"), HasSubstr("is not a valid clip name"));
  EXPECT_THAT(error_of(",1,2\n"), HasSubstr("has no file name"));
  EXPECT_THAT(error_of("file,name\na,b\n"), HasSubstr("no column"));
  EXPECT_THAT(error_of("\n\n"), HasSubstr("no rows"));
}

TEST_F(ClipTableTest, MakesOneInputPerRow) {
  const auto found =
      value_of(parts("a/walk.bvh,,2,kick\nin/b/walk.bvh,f3,,sub/x\nrun.npz,1,2\nrun.npz,2,3\n"));
  std::vector<std::string> names;
  for (const BatchInput& part : found) names.push_back(part.relative);
  EXPECT_THAT(names, ElementsAre("a/kick.bvh", "b/sub/x.bvh", "b/run_1.npz", "b/run_2.npz"));
  EXPECT_EQ(found[0].variant, (ClipVariant{"a/walk.bvh", ":2", ""}));
  EXPECT_EQ(found[1].path, "in/b/walk.bvh");
  EXPECT_EQ(found[1].variant.part, "f3:");
}

TEST_F(ClipTableTest, RejectsUnknownInputsAndDuplicateClips) {
  const auto error = [&](const std::string& text) { return describe(parts(text).error()); };
  EXPECT_THAT(error("walk.bvh,1,2\n"),
              HasSubstr("parts.csv:1: error: \"walk.bvh\" matches no motion"));
  EXPECT_THAT(error("a/walk.bvh,1,2\na/wolk.bvh,1,2\n"), HasSubstr("did you mean \"a/walk.bvh\"?"));
  EXPECT_THAT(error("a/walk.bvh,1,2,x\na/walk.bvh,2,3,x\n"),
              HasSubstr("already defined in line 1"));
}

TEST(ClipVariants, PartsBecomeOptions) {
  const PartOptions seconds = part_options("1.5:3");
  EXPECT_EQ(seconds.start_s, 1.5);
  EXPECT_EQ(seconds.end_s, 3.0);
  EXPECT_EQ(part_options("f10:").frames, "10:");
  EXPECT_EQ(part_options(":f20").frames, ":20");
  EXPECT_EQ(part_options(":2").start_s, -1.0);
  EXPECT_EQ(part_options("").frames, "");
}

TEST(ClipVariants, MirrorImagesFollowTheirClips) {
  const auto both = with_mirror_images({input_at("a/walk.two.bvh")});
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].variant, ClipVariant{});
  EXPECT_EQ(both[1].relative, "a/walk.two_mirrored.bvh");
  EXPECT_EQ(both[1].variant.mirror_of, "a/walk.two.bvh");
  EXPECT_EQ(both[1].variant.source, "a/walk.two.bvh");
}

}  // namespace
}  // namespace retarget
