#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "retarget/load_robot.h"
#include "retarget/robots.h"
#include "support/value_of.h"

namespace retarget {

inline std::filesystem::path robots_folder() {
  return std::filesystem::path(RETARGET_SOURCE_DIR) / "robots";
}

/// A robot of the repository with its profile.
inline std::shared_ptr<const Robot> load_shipped(const std::string& name) {
  const auto files = value_of(find_robot(name, {robots_folder()}));
  return value_of(load_robot_files(files.model.string(), files.profile.string()));
}

}  // namespace retarget
