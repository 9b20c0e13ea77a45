#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "retarget/error.h"

namespace retarget {

/// The files of a robot's folder: text by file name.
using FileTexts = std::map<std::string, std::string>;

/// Controls how put_robot_folder treats existing files.
struct PutOptions {
  bool replace = false;  ///< Replace an existing folder if `may_replace` accepts it.
  std::function<bool(const std::filesystem::path&)> may_replace;
  std::string otherwise;  ///< Explains in the message why a folder is not replaced.
  /// Checks the files after they are written; empty: no check. An error of kind kConfig is returned
  /// unchanged and nothing is left behind.
  std::function<Result<void>(const std::filesystem::path&)> check;
};

/// Checks that a text is a valid name for a robot and its folder. Errors: kUsage.
[[nodiscard]] Result<void> check_robot_name(const std::string& name);

/// Writes a robot's folder atomically: completely or not at all.
/// Errors: kUsage if the parent does not exist, or if the folder exists and is not replaced; kRun.
[[nodiscard]] Result<void> put_robot_folder(const std::filesystem::path& folder,
                                            const FileTexts& files, const PutOptions& options);

}  // namespace retarget
