#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "retarget/load_robot.h"
#include "retarget/robots.h"

namespace retarget {

inline std::filesystem::path robots_folder() {
  return std::filesystem::path(RETARGET_SOURCE_DIR) / "robots";
}

/// A robot of the repository with its profile.
inline std::shared_ptr<const Robot> load_shipped(const std::string& name) {
  const auto files = find_robot(name, {robots_folder()});
  EXPECT_TRUE(files.has_value()) << (files ? "" : describe(files.error()));
  if (!files) return nullptr;
  const auto robot = load_robot_files(files->model.string(), files->profile.string());
  EXPECT_TRUE(robot.has_value()) << (robot ? "" : describe(robot.error()));
  return robot ? *robot : nullptr;
}

}  // namespace retarget
