#include "batch/resume.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "support/temporary_folder.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

class ResumeTest : public ::testing::Test {
 protected:
  ResumeTest() {
    fs::create_directory(folder_.path() / "out");
    input_ = folder_.write("walk.bvh", "input");
    output_ = folder_.write("out/walk.csv", "output");
    entry_.relative = "walk.bvh";
    entry_.robot = "g1";
    entry_.done = true;
    entry_.options_hash = "options";
    entry_.input = record_file(input_, input_, FileUse::kInput).value();
    entry_.outputs = {record_file(output_, "walk.csv", FileUse::kOutput).value()};
  }
  [[nodiscard]] FinishedClips::Candidate find(const std::string& options = "options") {
    clips_ = FinishedClips({entry_}, (folder_.path() / "out").string());
    return clips_.find("walk.bvh", "g1", options, input_);
  }
  static void touch(const std::string& path) {
    fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(3));
  }

  TemporaryFolder folder_;
  std::string input_, output_;
  ManifestEntry entry_;
  FinishedClips clips_;
};

TEST_F(ResumeTest, UntouchedFilesNeedNoReading) {
  EXPECT_EQ(find().state, RecordState::kSame);
  EXPECT_TRUE(clips_.still_holds(*find().entry, input_));
}

TEST_F(ResumeTest, TouchedFilesAreComparedByContent) {
  for (const std::string& path : {input_, output_}) {
    touch(path);
    const auto found = find();
    EXPECT_EQ(found.state, RecordState::kUnsure);
    EXPECT_TRUE(clips_.still_holds(*found.entry, input_));
  }
}

TEST_F(ResumeTest, DetectsChangedContentOfTheSameSize) {
  for (const char* name : {"walk.bvh", "out/walk.csv"}) {
    const auto size = fs::file_size(folder_.path() / name);
    folder_.write(name, std::string(size, 'X'));
    touch((folder_.path() / name).string());
    const auto found = find();
    EXPECT_EQ(found.state, RecordState::kUnsure);
    EXPECT_FALSE(clips_.still_holds(*found.entry, input_));
  }
}

TEST_F(ResumeTest, ListsClipsToRedo) {
  EXPECT_EQ(find("others").entry, nullptr);
  folder_.write("walk.bvh", "longer input");
  EXPECT_EQ(find().entry, nullptr);
  folder_.write("walk.bvh", "input");
  fs::remove(output_);
  EXPECT_EQ(find().entry, nullptr);
  folder_.write("out/walk.csv", "out");
  EXPECT_EQ(find().entry, nullptr);
  folder_.write("out/walk.csv", "output");
  entry_.done = false;
  EXPECT_EQ(find().entry, nullptr);
  entry_.done = true;
  EXPECT_NE(find().entry, nullptr);
  entry_.outputs.clear();
  EXPECT_EQ(find().entry, nullptr);
}

TEST_F(ResumeTest, TheSidecarOfARobotMotionBelongsToTheInput) {
  input_ = folder_.write("walk.csv", "input");
  const auto plain = record_file(input_, input_, FileUse::kInput).value();
  const std::string sidecar = folder_.write("walk.csv.json", "{}");
  const auto described = record_file(input_, input_, FileUse::kInput).value();
  EXPECT_EQ(look_at(plain, input_, FileUse::kInput), RecordState::kChanged);
  EXPECT_EQ(described.bytes, plain.bytes + 2);
  folder_.write("walk.csv.json", "[]");
  EXPECT_FALSE(has_recorded_content(described, input_, FileUse::kInput));
  fs::remove(sidecar);
  EXPECT_EQ(look_at(described, input_, FileUse::kInput), RecordState::kChanged);
  // An output and its sidecar have separate records.
  const auto output = record_file(input_, input_, FileUse::kOutput).value();
  folder_.write("walk.csv.json", "{}");
  EXPECT_TRUE(has_recorded_content(output, input_, FileUse::kOutput));
}

TEST_F(ResumeTest, AcceptsAnyOfSeveralEntries) {
  ManifestEntry other = entry_;
  other.options_hash = "others";
  ManifestEntry stale = entry_;
  stale.input.bytes = 1;
  clips_ = FinishedClips({other, entry_, stale}, (folder_.path() / "out").string());
  EXPECT_EQ(clips_.find("walk.bvh", "g1", "options", input_).state, RecordState::kSame);
  EXPECT_EQ(clips_.find("walk.bvh", "h1", "options", input_).entry, nullptr);
}

TEST_F(ResumeTest, HandlesFilesThatCannotBeRecorded) {
  EXPECT_FALSE(record_file((folder_.path() / "missing").string(), "x", FileUse::kInput));
  EXPECT_FALSE(record_file(folder_.path().string(), "x", FileUse::kInput));
}

TEST_F(ResumeTest, RemovesOnlyFilesThatMatchTheRecord) {
  const auto verified = [&] {
    const FinishedClips clips({entry_}, (folder_.path() / "out").string());
    return clips.outputs_of("walk.bvh", "g1", true);
  };
  EXPECT_EQ(verified(), std::vector<std::string>{"walk.csv"});
  // The file has the same size but was edited.
  folder_.write("out/walk.csv", "OUTPUT");
  EXPECT_TRUE(verified().empty());
  folder_.write("out/walk.csv", "output");
  entry_.outputs.front().hash.clear();
  EXPECT_TRUE(verified().empty());
  // A file outside the folder by its name, and one through a link.
  const std::string victim = folder_.write("victim.txt", "victim");
  entry_.outputs = {record_file(victim, "../victim.txt", FileUse::kOutput).value()};
  EXPECT_TRUE(verified().empty());
  entry_.outputs = {record_file(victim, victim, FileUse::kOutput).value()};
  EXPECT_TRUE(verified().empty());
#ifndef _WIN32
  fs::create_directory_symlink("..", folder_.path() / "out" / "up");
  entry_.outputs = {record_file(victim, "up/victim.txt", FileUse::kOutput).value()};
  EXPECT_TRUE(verified().empty());
#endif
}

}  // namespace
}  // namespace retarget
