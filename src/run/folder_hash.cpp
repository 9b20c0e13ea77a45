#include "run/folder_hash.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "base/try.h"
#include "provenance/hash.h"

namespace retarget {

namespace fs = std::filesystem;

Result<std::string> folder_hash(const fs::path& folder, std::string_view ending) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    const bool counts = ending.empty() || at->path().extension() == ending;
    if (counts && at->is_regular_file(error)) files.push_back(at->path());
  }
  std::ranges::sort(files);
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  for (const fs::path& file : files) {
    TRY_ASSIGN(const std::string hash, hash_file(file.string(), ErrorKind::kConfig));
    hasher.update(file.filename().string() + " " + hash + "\n");
  }
  return hasher.finish();
}

}  // namespace retarget
