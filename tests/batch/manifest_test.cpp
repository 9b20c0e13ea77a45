#include "batch/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

ManifestEntry entry_of(const std::string& relative, const std::string& finished = "") {
  ManifestEntry entry;
  entry.relative = relative;
  entry.robot = "unitree_g1";
  entry.done = true;
  entry.finished = finished;
  return entry;
}

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ManifestLine, RoundTrips) {
  ManifestEntry entry = entry_of("a b/\"w\".bvh", "2026-01-31T12:00:00Z");
  entry.done = false;
  entry.options_hash = "0123";
  entry.input = {"in/a b/\"w\".bvh", 1U << 31U, 1'700'000'000'123'456'789, "abcd"};
  entry.outputs = {{"a b/w.csv", 12, 5, "ef"}, {"a b/w.npz", 13, 6, "01"}};
  entry.frames = 7;
  entry.fps = 29.97;
  entry.seconds = 0.25;
  Error error;
  error.location.file = "in/x.bvh";
  error.location.line = 3;
  error.location.column = 4;
  error.message = "not \"this\"";
  error.hint = "that";
  entry.error = error;
  entry.exit_code = 3;
  entry.taken_as = "CMU";
  entry.config = "robots/r/ik.json";
  entry.warnings = {"one", "two"};
  entry.notes = {"three"};
  entry.quality = ClipQuality{{{"jumps", 2.0}, {"limit_pct", 0.5}}, {"jumps"}, "jumps", HUGE_VAL};
  const std::string line = manifest_line(entry);
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const auto read = parse_manifest_line(line).value();
  EXPECT_EQ(manifest_line(read), line);
  EXPECT_EQ(read.input.modified_ns, entry.input.modified_ns);
  EXPECT_EQ(read.input.bytes, entry.input.bytes);
  EXPECT_EQ(read.outputs.at(1).hash, "01");
  EXPECT_EQ(read.error->location.column, 4U);
  EXPECT_EQ(read.error->hint, "that");
  EXPECT_EQ(read.exit_code, 3);
  EXPECT_EQ(read.config, "robots/r/ik.json");
  EXPECT_EQ(read.quality->figures.at(1).second, 0.5);
  EXPECT_EQ(read.quality->worst_ratio, HUGE_VAL);
  EXPECT_FALSE(read.done);
}

TEST(ManifestLine, NonUtf8NamesRoundTrip) {
  ManifestEntry entry = entry_of("a\xff\xfe/b.bvh");
  entry.outputs = {{"a\xff\xfe/b.csv", 1, 1, ""}};
  const std::string line = manifest_line(entry);
  EXPECT_THAT(line, Not(HasSubstr("\xff")));
  const auto read = parse_manifest_line(line).value();
  EXPECT_EQ(read.relative, entry.relative);
  EXPECT_EQ(read.outputs.at(0).file, "a\xff\xfe/b.csv");
}

TEST(ManifestLine, SkipsUnknownMembersAndWrongTypes) {
  const auto read =
      parse_manifest_line(
          R"({"later": [1], "relative": "a.bvh", "status": "done", "frames": "many", "input": 3,
          "outputs": {"x": 1}, "quality": [], "warnings": [1, "w"]})")
          .value();
  EXPECT_EQ(read.frames, 0);
  EXPECT_THAT(read.warnings, ElementsAre("w"));
}

TEST(ManifestLine, RejectsLinesThatAreNotEntries) {
  for (const char* line : {"", "{", "[]", "3", R"({"relative": "a.bvh"})", R"({"status": "done"})",
                           R"({"relative": "a.bvh", "status": "do)", "\xff\xfe", "\0"}) {
    EXPECT_FALSE(parse_manifest_line(line)) << line;
  }
}

TEST(Manifest, ReadsTruncatedFilesUpToTheLastWholeLine) {
  const TemporaryFolder folder;
  const std::string whole = manifest_line(entry_of("a.bvh")) + manifest_line(entry_of("b.bvh"));
  const std::size_t first = whole.find('\n') + 1;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const auto read = value_of(read_manifest(folder.write("m", whole.substr(0, size))));
    // A line that only lacks its line feed is complete.
    const std::size_t complete = size + 1 >= whole.size() ? 2 : size + 1 >= first ? 1 : 0;
    EXPECT_EQ(read.entries.size(), complete) << size;
    const bool torn = size != 0 && size != first && size + 1 != first && size + 1 < whole.size();
    EXPECT_EQ(read.unreadable, torn ? 1 : 0) << size;
  }
}

TEST(Manifest, MissingFileIsEmpty) {
  const auto read = value_of(read_manifest("no/such/manifest"));
  EXPECT_TRUE(read.entries.empty());
}

TEST(Manifest, ConcurrentLinesAreWhole) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "m").string();
  const std::vector<ManifestEntry> kept = {entry_of("kept.bvh")};
  {
    auto writer = value_of(ManifestWriter::begin(path, kept));
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (int i = 0; i < 25; ++i) {
          EXPECT_TRUE(writer->append(entry_of(std::to_string(100 * t + i) + ".bvh")));
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  const auto read = value_of(read_manifest(path));
  EXPECT_EQ(read.entries.size(), 101U);
  EXPECT_EQ(read.unreadable, 0);
  EXPECT_EQ(read.entries.front().relative, "kept.bvh");
  EXPECT_EQ(text_of(path).back(), '\n');
}

TEST(Manifest, BeginReplacesAnExistingFile) {
  const TemporaryFolder folder;
  const std::string path = folder.write("m", "torn");
  ASSERT_TRUE(ManifestWriter::begin(path, {}));
  EXPECT_EQ(text_of(path), "");
}

TEST(ManifestLine, SkipsNumbersOutOfRange) {
  for (const char* number : {"1e300", "-1e300", "99999999999999999999", "-9223372036854775809",
                             "4294967296", "-4294967297", "1.5"}) {
    const std::string text(number);
    const auto entry = parse_manifest_line(
        "{\"relative\": \"a\", \"status\": \"done\", \"frames\": " + text +
        ", \"input\": {\"file\": \"a\", \"bytes\": -1, \"modified_ns\": 1e300}}");
    ASSERT_TRUE(entry) << number;
    EXPECT_EQ(entry->frames, 0) << number;
    EXPECT_EQ(entry->input.bytes, 0U);
    EXPECT_EQ(entry->input.modified_ns, 0);
  }
}

TEST(Manifest, IgnoresLinesThatNameOutsideFiles) {
  const TemporaryFolder folder;
  std::vector<ManifestEntry> entries(7, entry_of("a.bvh"));
  entries[1].outputs = {{"ok.csv", 1, 1, ""}, {"../victim.txt", 1, 1, ""}};
  entries[2].outputs = {{"/etc/passwd", 1, 1, ""}};
  entries[3].relative = "../../a.bvh";
  entries[4].robot = "..";
  entries[5].robot = "a/../../b";
  entries[6].outputs = {{"a/../../b.csv", 1, 1, ""}};
  std::string text;
  for (const ManifestEntry& entry : entries) text += manifest_line(entry);
  const auto content = value_of(read_manifest(folder.write("manifest.jsonl", text)));
  EXPECT_EQ(content.entries.size(), 1U);
  EXPECT_EQ(content.outside, 6);
  EXPECT_EQ(content.outside_name, "../victim.txt");
  EXPECT_EQ(content.unreadable, 0);
}

TEST(Manifest, ClockSkewDoesNotChangeTheLatestEntry) {
  constexpr std::int64_t kNow = 1'767'225'600'123;  // 2026-01-01T00:00:00.123Z
  EXPECT_EQ(finished_after(kNow, ""), "2026-01-01T00:00:00.123Z");
  EXPECT_EQ(finished_after(kNow, "2025-12-31T23:59:59.999Z"), "2026-01-01T00:00:00.123Z");
  EXPECT_EQ(finished_after(kNow, "2026-01-01T00:00:00.123Z"), "2026-01-01T00:00:00.124Z");
  EXPECT_EQ(finished_after(kNow, "2031-05-06T07:08:59.999Z"), "2031-05-06T07:09:00.000Z");
  EXPECT_EQ(finished_after(kNow, "2031-05-06T07:08:09Z"), "2031-05-06T07:08:09.001Z");
  for (const char* odd : {"tomorrow", "9", "zzzz-zz-zzTzz:zz:zzZ", "2031-05-06T07:08:09.x99Z"}) {
    EXPECT_EQ(finished_after(kNow, odd), "2026-01-01T00:00:00.123Z") << odd;
  }
}

TEST(LatestEntries, KeepTheLastOfEveryClipAndRobotInOrder) {
  ManifestEntry other = entry_of("a.bvh", "2026-01-01T00:00:05Z");
  other.robot = "booster_t1";
  ManifestEntry old = entry_of("b.bvh", "2026-01-01T00:00:01Z");
  old.frames = 1;
  ManifestEntry newer = entry_of("b.bvh", "2026-01-01T00:00:02Z");
  newer.frames = 2;
  ManifestEntry newest = newer;
  newest.frames = 3;
  const auto latest = latest_entries({newer, newest, entry_of("a.bvh"), old, other});
  ASSERT_EQ(latest.size(), 3U);
  EXPECT_EQ(latest[0].robot, "booster_t1");
  EXPECT_EQ(latest[1].relative, "a.bvh");
  EXPECT_EQ(latest[2].frames, 3);
}

}  // namespace
}  // namespace retarget
