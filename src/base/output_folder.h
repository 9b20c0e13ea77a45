#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A folder that is written completely or not at all.
///
/// Files go to a temporary folder next to `path`. `commit` moves it to `path` in one step and
/// removes a folder that was there before. Destruction without commit discards the temporary
/// folder.
class OutputFolder {
 public:
  /// Creates the temporary folder. Errors: the parent folder is missing; (kUsage) `path` is a file,
  /// or a folder with files that are not in `own` and would be lost.
  /// @param own  names of files that an existing folder may hold.
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
  std::string temporary_;  // Empty after commit or discard.
};

}  // namespace retarget
