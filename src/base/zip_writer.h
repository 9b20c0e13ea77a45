#pragma once

#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Builds a ZIP archive of files that are not compressed. Entries have no date, so that the same
/// files give the same bytes.
class ZipWriter {
 public:
  void add(std::string_view name, std::string_view content);
  /// The whole archive. Errors (kRun): 4 GiB or more, which plain ZIP archives cannot hold.
  [[nodiscard]] Result<std::string> finish();

 private:
  std::string bytes_;
  std::string directory_;
  int count_ = 0;
};

}  // namespace retarget
