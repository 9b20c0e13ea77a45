#include "app/run/folder_hash.h"

#include "app/provenance/hash.h"
#include "base/try.h"
#include "retarget/file.h"

namespace retarget {

namespace fs = std::filesystem;

Result<std::string> folder_hash(const fs::path& folder, std::string_view ending) {
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  for (const fs::path& file : files_in_folder(folder)) {
    const bool counts = ending.empty() || file.extension() == ending;
    if (!counts || !is_file(file)) continue;
    TRY_ASSIGN(const std::string hash, hash_file(file.string(), ErrorKind::kConfig));
    hasher.update(file.filename().string() + " " + hash + "\n");
  }
  return hasher.finish();
}

}  // namespace retarget
