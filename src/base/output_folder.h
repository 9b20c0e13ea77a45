#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A folder of files that appears whole or not at all.
///
/// Files go to a temporary folder beside `path`, which `commit` puts in its place in one step; a
/// folder that was there goes away. Destroyed without commit, nothing remains.
class OutputFolder {
 public:
  /// Errors: no folder to be in, something else there; (kUsage) a folder with files of other names
  /// than `own`, which are not ours to remove.
  /// @param own  names of files that the folder may hold already.
  [[nodiscard]] static Result<OutputFolder> create(const std::string& path,
                                                   const std::vector<std::string>& own);
  ~OutputFolder();
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) noexcept;
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  [[nodiscard]] Result<void> write(const std::string& name, std::string_view bytes);
  [[nodiscard]] Result<void> commit();

 private:
  OutputFolder() = default;
  void discard();

  std::string path_;
  std::string temporary_;  // empty: nothing is left to do
};

}  // namespace retarget
