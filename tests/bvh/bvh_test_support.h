#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "support/value_of.h"

namespace retarget {

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream.good()) << path;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Returns the cells of a tab-separated file below its heading.
inline std::vector<std::vector<std::string>> table_rows(const std::filesystem::path& path) {
  std::istringstream lines(file_text(path));
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, '\t');) rows.back().push_back(cell);
  }
  return rows;
}

/// Calls read_bvh on a copy that ends where its memory ends, so that a sanitizer sees any read past
/// it.
inline Result<BvhFile> read_exactly(std::string_view text, const BvhReadOptions& options = {}) {
  const std::unique_ptr<char[]> bytes(new char[text.size()]);
  if (!text.empty()) std::memcpy(bytes.get(), text.data(), text.size());
  return read_bvh({bytes.get(), text.size()}, "test.bvh", options);
}

/// Returns the clip of a valid text.
inline Clip clip_of(std::string_view text, const BvhReadOptions& options = {}) {
  return value_of(read_exactly(text, options)).clip;
}

/// Asserts bit-identical motions. Ignores names, channels and end sites.
inline void expect_same_motion(const Clip& a, const Clip& b) {
  ASSERT_EQ(a.skeleton().joint_count(), b.skeleton().joint_count());
  ASSERT_EQ(a.frame_count(), b.frame_count());
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    for (int joint = 0; joint < a.skeleton().joint_count(); ++joint) {
      EXPECT_EQ(a.rotations(frame)[joint].coeffs(), b.rotations(frame)[joint].coeffs())
          << "frame " << frame << ", joint " << joint;
      EXPECT_EQ(a.translation(frame, joint), b.translation(frame, joint))
          << "frame " << frame << ", joint " << joint;
    }
  }
}

inline std::string warnings_of(const BvhFile& file) {
  std::string text;
  for (const Warning& warning : file.warnings) text += describe(warning, "test.bvh") + "\n";
  return text;
}

}  // namespace retarget
