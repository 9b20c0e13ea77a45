// For any bytes, the reader returns a clip or an error. It does not crash, and its memory is
// bounded by the file's size.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#ifndef _WIN32
#include <sys/resource.h>
#endif

#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "base/option_name.h"
#include "bvh_test_support.h"
#include "formats/bvh/read_bvh.h"
#include "retarget/bvh.h"

namespace retarget {
namespace {

std::string conformance_text(const std::string& name) {
  return file_text(std::filesystem::path(RETARGET_SOURCE_DIR) / "tests/bvh/conformance" /
                   (name + ".bvh"));
}

void expect_sound(const Result<BvhFile>& file, std::string_view text) {
  if (!file) {
    EXPECT_FALSE(file.error().message.empty());
    return;
  }
  const Clip& clip = file->clip;
  EXPECT_LE(static_cast<std::size_t>(clip.frame_count()), text.size());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (const auto& rotation : clip.rotations(frame)) EXPECT_NEAR(rotation.norm(), 1.0, 1e-9);
    for (const auto& translation : clip.translations(frame)) {
      EXPECT_TRUE(translation.allFinite());
    }
  }
}

void read_every_way(std::string_view text) {
  for (const bool lenient : {false, true}) {
    for (const bool motion_optional : {false, true}) {
      BvhReadOptions options;
      options.lenient = lenient;
      options.motion_optional = motion_optional;
      expect_sound(read_exactly(text, options), text);
    }
  }
}

long peak_kilobytes() {
#ifdef _WIN32
  return 0;  // Not measured.
#else
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
#endif
}

TEST(BvhRobustness, ReadsOrRejectsEveryTruncation) {
  for (const char* name : {"base", "nine_ch", "comment", "crlf", "wrapped_row"}) {
    const std::string text = conformance_text(name);
    for (std::size_t size = 0; size <= text.size(); ++size) {
      read_every_way(std::string_view(text).substr(0, size));
    }
  }
}

TEST(BvhRobustness, NeverReadsATruncatedFileAsComplete) {
  const std::string text = conformance_text("base");
  // Without the last digit of its last value, the file is still complete for any reader.
  for (std::size_t size = 0; size + 2 < text.size(); ++size) {
    EXPECT_FALSE(read_exactly(std::string_view(text).substr(0, size)).has_value()) << size;
  }
}

TEST(BvhRobustness, ReadsOrRejectsRandomDamage) {
  std::mt19937 random(4711);
  std::vector<std::string> texts;
  for (const char* name : {"base", "joint_pos", "two_roots", "comment", "end_channels",
                           "wrapped_row", "frames_too_few", "trailing_junk"}) {
    texts.push_back(conformance_text(name));
  }
  const std::vector<std::string> pieces = {"{",
                                           "}",
                                           "\n",
                                           "\r",
                                           "-",
                                           "1e999",
                                           "nan",
                                           "MOTION",
                                           "JOINT x",
                                           "End Site {",
                                           "# c\n",
                                           "\t",
                                           ".",
                                           "999999999",
                                           "OFFSET",
                                           "CHANNELS 9",
                                           std::string("\0", 1)};
  for (int i = 0; i < 6000; ++i) {
    std::string text = texts[random() % texts.size()];
    const int edits = 1 + static_cast<int>(random() % 4);
    for (int edit = 0; edit < edits && !text.empty(); ++edit) {
      const std::size_t at = random() % text.size();
      const std::size_t length = random() % 12;
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          text.insert(at, pieces[random() % pieces.size()]);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), 2 * length));
          break;
      }
    }
    read_every_way(text);
  }
}

TEST(BvhRobustness, DeepNestingDoesNotOverflowTheStack) {
  const std::string text = conformance_text("deep");
  const Clip clip = clip_of(text);
  EXPECT_EQ(clip.skeleton().joint_count(), 3000);
  EXPECT_EQ(clip.skeleton().joint(2999).parent, 2998);
  EXPECT_FALSE(read_exactly(std::string_view(text).substr(0, text.size() / 2)).has_value());
  std::string braces = "HIERARCHY\nROOT a {";
  for (int i = 0; i < 200000; ++i) braces += "JOINT b{";
  EXPECT_FALSE(read_exactly(braces).has_value());
}

TEST(BvhRobustness, MemoryDependsOnTheFileNotItsHeader) {
  const long before = peak_kilobytes();
  std::string text = conformance_text("huge_frames");
  BvhReadOptions lenient;
  lenient.lenient = true;
  EXPECT_FALSE(read_exactly(text).has_value());
  EXPECT_TRUE(read_exactly(text, lenient).has_value());
  text.replace(text.find("2000000000"), 10, "9223372036854775807");
  EXPECT_FALSE(read_exactly(text).has_value());
  EXPECT_TRUE(read_exactly(text, lenient).has_value());
  EXPECT_FALSE(read_exactly("HIERARCHY\nROOT a\n{\nCHANNELS 2000000000 Xrotation\n}").has_value());
  EXPECT_LT(peak_kilobytes() - before, 20000);
}

TEST(BvhRobustness, JointsWithoutChannelsDoNotExhaustMemory) {
  std::string text = "HIERARCHY\nROOT a{OFFSET 0 1 0 CHANNELS 1 Xrotation\n";
  for (int i = 0; i < 2000; ++i) text += "JOINT j" + std::to_string(i) + "{OFFSET 0 0 0}";
  text += "}\nMOTION\nFrames: 40000\nFrame Time: 0.01\n";
  const std::string head = text;
  for (int i = 0; i < 40'000; ++i) text += "0\n";
  const long before = peak_kilobytes();
  const Result<BvhFile> file = read_exactly(text);
  ASSERT_FALSE(file.has_value());
  EXPECT_EQ(
      file.error().message,
      "40000 frames of 2001 joints need 2561.3 MB of memory, at most 33.6 MB are allowed for a "
      "file of this size");
  EXPECT_LT(peak_kilobytes() - before, 80'000);
  // Missing rows are an error unless the reader is lenient.
  EXPECT_FALSE(read_exactly(head + "0\n").has_value());
  BvhReadOptions lenient;
  lenient.lenient = true;
  EXPECT_EQ(clip_of(head + "0\n", lenient).frame_count(), 1);
}

TEST(BvhRobustness, ClipStaysWithinTheMemoryLimit) {
  std::string text = "HIERARCHY\nROOT a{OFFSET 0 1 0 CHANNELS 1 Xrotation}\n";
  text += "MOTION\nFrames: 3\nFrame Time: 0.01\n0\n0\n0\n";
  BvhReadOptions options;
  options.max_clip_bytes = 96;
  EXPECT_EQ(clip_of(text, options).frame_count(), 3);
  options.max_clip_bytes = 95;
  const Result<BvhFile> file = read_exactly(text, options);
  ASSERT_FALSE(file.has_value());
  EXPECT_THAT(file.error().hint, ::testing::HasSubstr(OPTION("memory")));
}

TEST(BvhRobustness, AcceptedFilesCanBeWritten) {
  const std::filesystem::path folder =
      std::filesystem::path(RETARGET_SOURCE_DIR) / "tests/bvh/conformance";
  int written = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".bvh") continue;
    const Result<BvhFile> file = read_exactly(file_text(entry.path()));
    if (!file) continue;
    const Result<std::string> text = format_bvh(file->clip);
    ASSERT_TRUE(text.has_value()) << entry.path() << describe(text.error());
    const Clip back = clip_of(*text);
    ASSERT_EQ(back.skeleton().names(), file->clip.skeleton().names());
    ASSERT_EQ(back.frame_count(), file->clip.frame_count());
    for (int frame = 0; frame < back.frame_count(); ++frame) {
      for (int joint = 0; joint < back.skeleton().joint_count(); ++joint) {
        EXPECT_LT(back.rotations(frame)[joint].angularDistance(file->clip.rotations(frame)[joint]),
                  1e-9);
        EXPECT_EQ(back.translation(frame, joint), file->clip.translation(frame, joint));
      }
    }
    ++written;
  }
  EXPECT_EQ(written, 40);
}

}  // namespace
}  // namespace retarget
