#include "batch/file_facts.h"

#include <sys/stat.h>

#include <algorithm>

#include "retarget/file.h"
#include "retarget/file_endings.h"

namespace retarget {
namespace {

FileFacts facts_in(const struct stat& info) {
  return {static_cast<std::uint64_t>(info.st_size),
          std::int64_t{info.st_mtim.tv_sec} * 1'000'000'000 + std::int64_t{info.st_mtim.tv_nsec}};
}

}  // namespace

std::optional<FileFacts> facts_of(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return std::nullopt;
  if (S_ISREG(info.st_mode)) return facts_in(info);
  if (!S_ISDIR(info.st_mode) || !is_sonic_folder(path)) return std::nullopt;
  FileFacts all;
  for (const auto& file : files_in_folder(path)) {
    if (::stat(file.c_str(), &info) != 0) continue;
    const FileFacts one = facts_in(info);
    all.bytes += one.bytes;
    all.modified_ns = std::max(all.modified_ns, one.modified_ns);
  }
  return all;
}

}  // namespace retarget
