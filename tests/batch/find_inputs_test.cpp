#include "batch/find_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/stat.h>
#include <unistd.h>
#endif

#include <filesystem>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class FindInputsTest : public ::testing::Test {
 protected:
  void make(const std::string& name, const std::string& text = "x") const {
    fs::create_directories((folder_.path() / name).parent_path());
    folder_.write(name, text);
  }
  [[nodiscard]] std::string at(const std::string& name) const {
    return (folder_.path() / name).string();
  }
  static std::vector<std::string> relatives(const Result<FoundInputs>& found) {
    std::vector<std::string> all;
    if (!found) return {describe(found.error())};
    for (const BatchInput& input : found->inputs) all.push_back(input.relative);
    return all;
  }
  [[nodiscard]] Result<FoundInputs> find(const std::vector<std::string>& names) const {
    InputSearch search;
    search.names = names;
    return find_inputs(search);
  }

  TemporaryFolder folder_;
};

TEST_F(FindInputsTest, KeepsFolderStructure) {
  for (const char* name :
       {"in/walk.bvh", "in/sub/a b/run.BVH", "in/sub/-dash.bvh", "in/l\xc3\xa4uft.bvh",
        "in/motion.npz", "in/notes.txt", "in/.bvh", "in/two.dots.bvh", "in/sub/._walk.bvh"}) {
    make(name);
  }
#ifdef _WIN32
  EXPECT_THAT(relatives(find({at("in")})),
              ElementsAre("l\xc3\xa4uft.bvh", "motion.npz", "sub/-dash.bvh", "sub/a b/run.BVH",
                          "two.dots.bvh", "walk.bvh"));
#else
  for (const char* name : {"in/bad\xff utf.bvh", "in/new\nline.bvh"}) make(name);
  const auto found = find({at("in")});
  EXPECT_THAT(relatives(found),
              ElementsAre("bad\xff utf.bvh", "l\xc3\xa4uft.bvh", "motion.npz", "new\nline.bvh",
                          "sub/-dash.bvh", "sub/a b/run.BVH", "two.dots.bvh", "walk.bvh"));
  EXPECT_THAT(found->notes, ElementsAre(HasSubstr("1 file named ._*"),
                                        "skipped 1 file without a human motion: .txt"));
  EXPECT_EQ(found->inputs.back().path, at("in/walk.bvh"));
  EXPECT_EQ(found->inputs.back().bytes, 1U);
  EXPECT_GT(found->inputs.back().modified_ns, 0);
#endif
}

// A pickled dictionary in protocol 2, without its frame.
std::string dictionary(const std::vector<std::string>& keys, const std::string& value) {
  std::string text = "}(";
  for (const std::string& key : keys) {
    text += std::string("U") + static_cast<char>(key.size()) + key + value;
  }
  return text + "u";
}

std::string numbers(const std::vector<std::string>& keys) {
  return dictionary(keys, "K\x01");
}

std::string pickle(const std::string& value) {
  return "\x80\x02" + value + ".";
}

TEST_F(FindInputsTest, FindsPicklesOfHumansByTheirContent) {
  const std::string human = pickle(numbers({"poses", "trans"}));
  for (const char* name : {"in/a.pkl", "in/b/c.P", "in/d.joblib", "in/e.pickle"}) make(name, human);
  make("in/several.pkl", pickle(dictionary({"x", "y"}, numbers({"poses", "trans"}))));
  make("in/robot.pkl", pickle(numbers({"fps", "root_pos", "root_rot", "dof_pos"})));
  make("in/robots.pkl", pickle(dictionary({"walk"}, numbers({"root_trans_offset", "pose_aa"}))));
  make("in/weights.pkl", pickle(numbers({"layer"})));
  make("in/not_a_pickle.pkl", "words");
  make("in/walk.bvh.gz");
  const auto found = find({at("in")});
  EXPECT_THAT(relatives(found),
              ElementsAre("a.pkl", "b/c.P", "d.joblib", "e.pickle", "several.pkl"));
  EXPECT_THAT(found->notes, ElementsAre("skipped 5 files without a human motion: .gz, .pkl"));
  EXPECT_THAT(relatives(find({at("in/robot.pkl")})), ElementsAre("robot.pkl"));
}

// The batch must notice that a clip is missing. The content of other pickles is known.
TEST_F(FindInputsTest, KeepsPicklesThatCannotBeRead) {
  const std::string human = pickle(numbers({"poses", "trans"}));
  make("in/cut.pkl", human.substr(0, human.size() - 5));
  make("in/cut.pkl.joblib", std::string("\x78\x9c\x4b", 3));
  make("in/damaged.pkl", "\x80\x02\x07.");
  make("in/empty.p", "");
  make("in/object.pkl",
       "\x80\x02"
       "cchumpy.ch\nCh\n.");
  make("in/old.pkl", "(dp0\n.");
  const auto found = find({at("in")});
  EXPECT_THAT(relatives(found), ElementsAre("cut.pkl", "cut.pkl.joblib", "damaged.pkl", "empty.p"));
  EXPECT_THAT(found->notes, ElementsAre("skipped 2 files without a human motion: .pkl"));
}

TEST_F(FindInputsTest, DoesNotReadExcludedPickles) {
  make("in/a.pkl", "words");
  make("in/walk.bvh");
  InputSearch search;
  search.names = {at("in")};
  search.exclude = {"*.pkl"};
  const auto found = find_inputs(search);
  EXPECT_THAT(relatives(found), ElementsAre("walk.bvh"));
  EXPECT_THAT(found->notes, ElementsAre(HasSubstr("skipped 1 file because of")));
  EXPECT_THAT(found->unused_patterns, IsEmpty());
  search.exclude = {"*"};
  const auto none = find_inputs(search);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message, "all motion files are excluded");
}

#ifndef _WIN32  // creates links and pipes
TEST_F(FindInputsTest, FollowsLinksOnceAndSkipsLoops) {
  make("in/a/walk.bvh");
  make("elsewhere/run.bvh");
  fs::create_directory_symlink(at("in"), at("in/a/loop"));
  fs::create_directory_symlink(".", at("in/a/self"));
  fs::create_directory_symlink(at("elsewhere"), at("in/linked"));
  fs::create_symlink("nowhere", at("in/broken.bvh"));
  fs::create_symlink("nowhere", at("in/broken.pkl"));
  fs::create_symlink("round.bvh", at("in/round.bvh"));
  const auto found = find({at("in")});
  EXPECT_THAT(relatives(found),
              ElementsAre("a/walk.bvh", "broken.bvh", "broken.pkl", "linked/run.bvh", "round.bvh"));
  EXPECT_EQ(found->notes.size(), 2U);
}

TEST_F(FindInputsTest, SkipsPipesInFolders) {
  make("in/walk.bvh");
  ASSERT_EQ(::mkfifo(at("in/pipe.bvh").c_str(), 0600), 0);
  const auto found = find({at("in")});
  EXPECT_THAT(relatives(found), ElementsAre("walk.bvh"));
  EXPECT_THAT(found->notes, ElementsAre(HasSubstr("pipe.bvh")));
  EXPECT_FALSE(find({at("in/pipe.bvh")}));
}
#endif

TEST_F(FindInputsTest, PatternsKeepPathsBelowTheirFixedPart) {
  make("in/a/walk1.bvh");
  make("in/b/walk2.bvh");
  make("in/b/run.bvh");
  EXPECT_THAT(relatives(find({at("in/*/walk*.bvh")})), ElementsAre("a/walk1.bvh", "b/walk2.bvh"));
  EXPECT_THAT(relatives(find({at("in/[b]")})), ElementsAre("b/run.bvh", "b/walk2.bvh"));
  const auto none = find({at("in/*.bvh")});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kInput);
  make("in/[x].bvh");
  EXPECT_THAT(relatives(find({at("in/[x].bvh")})), ElementsAre("[x].bvh"));
}

TEST_F(FindInputsTest, ReadsListsOfFilesAndFolders) {
  make("in/a/walk.bvh");
  make("in/b/run.bvh");
  make("in/c.bvh");
  make("list.txt",
       "# a comment\r\n" + at("in/a/walk.bvh") + "\r\n\n" + at("in/b") + "\n" + at("in/gone.bvh"));
  EXPECT_THAT(relatives(find({"@" + at("list.txt")})),
              ElementsAre("gone.bvh", "run.bvh", "walk.bvh"));
  InputSearch search;
  search.lists = {at("list.txt")};
  search.base = at("in");
  EXPECT_THAT(relatives(find_inputs(search)), ElementsAre("a/walk.bvh", "b/run.bvh", "gone.bvh"));
  make("marked.txt", "\xef\xbb\xbf" + at("in/a/walk.bvh") + "\r\n");
  EXPECT_THAT(relatives(find({"@" + at("marked.txt")})), ElementsAre("walk.bvh"));
  EXPECT_EQ(fs::path(find({"@" + at("marked.txt")})->inputs.front().path),
            fs::path(at("in/a/walk.bvh")));
  search.base = at("in/b");
  const auto outside = find_inputs(search);
  ASSERT_FALSE(outside);
  EXPECT_EQ(outside.error().kind, ErrorKind::kUsage);
}

TEST_F(FindInputsTest, ReadsNulSeparatedLists) {
  make("in/new\nline.bvh");
  make("list", at("in/new\nline.bvh") + std::string(1, '\0'));
  EXPECT_THAT(relatives(find({"@" + at("list")})), ElementsAre("new\nline.bvh"));
}

TEST_F(FindInputsTest, SkipsExcludedFilesAndTheOutputFolder) {
  make("in/a/walk_stagei.npz");
  make("in/a/walk.npz");
  make("in/raw/walk.npz");
  make("in/out/walk.npz");
  InputSearch search;
  search.names = {at("in")};
  search.exclude = {"*_stagei.npz", "raw/*", "*_stagei*", "*.fbx"};
  search.output_folder = at("in/out");
  const auto found = find_inputs(search);
  EXPECT_THAT(relatives(found), ElementsAre("a/walk.npz"));
  EXPECT_THAT(found->notes,
              ElementsAre(HasSubstr("it is the output folder"), HasSubstr("skipped 2")));
  EXPECT_THAT(found->unused_patterns, ElementsAre("*.fbx"));
}

#ifndef _WIN32  // takes permissions away
TEST_F(FindInputsTest, UnreadableFoldersCountAsFailedClips) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  make("in/walk.bvh");
  make("in/closed/run.bvh");
  fs::permissions(at("in/closed"), fs::perms::none);
  const auto found = find({at("in")});
  fs::permissions(at("in/closed"), fs::perms::owner_all);
  EXPECT_THAT(relatives(found), ElementsAre("closed", "walk.bvh"));
  EXPECT_THAT(found->notes, ElementsAre(HasSubstr("cannot read the folder")));
}
#endif

TEST_F(FindInputsTest, NoInputsIsAnError) {
  fs::create_directory(at("empty"));
  for (const std::string& name : {at("empty"), at("missing"), "@" + at("missing")}) {
    const auto found = find({name});
    ASSERT_FALSE(found) << name;
    EXPECT_EQ(found.error().kind, ErrorKind::kInput);
  }
}

TEST_F(FindInputsTest, DeduplicatesFiles) {
  make("in/walk.bvh");
  EXPECT_THAT(relatives(find({at("in"), at("in/walk.bvh"), at("in/../in/walk.bvh")})),
              ElementsAre("walk.bvh"));
}

TEST(OutputStem, RemovesOnlyTheExtension) {
  EXPECT_EQ(output_stem("a.b/walk.x.BVH"), "a.b/walk.x");
  for (const char* name : {"a/b.pkl", "a/b.p", "a/b.joblib", "a/b.csv", "a/b.NPZ"}) {
    EXPECT_EQ(output_stem(name), "a/b") << name;
  }
  EXPECT_EQ(output_stem("walk"), "walk");
  EXPECT_EQ(output_stem("a/.bvh"), "a/.bvh");
}

TEST(DistinctOutputs, ReportsConflicts) {
  const std::vector<BatchInput> fine = {{"x/a.bvh", "a.bvh"}, {"x/b.bvh", "b.bvh"}};
  EXPECT_TRUE(check_distinct_outputs(fine));
  const std::vector<BatchInput> clash = {{"x/a.bvh", "a.bvh"}, {"y/a.bvh", "a.bvh"}};
  const auto refused = check_distinct_outputs(clash);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(refused.error().message, HasSubstr("\"x/a.bvh\" and \"y/a.bvh\""));
  const std::vector<BatchInput> kinds = {{"x/a.bvh", "a.bvh"}, {"x/a.npz", "a.npz"}};
  EXPECT_FALSE(check_distinct_outputs(kinds));
}

}  // namespace
}  // namespace retarget
