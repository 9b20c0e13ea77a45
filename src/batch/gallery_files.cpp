#include "batch/gallery_files.h"

#include <algorithm>
#include <system_error>

#include "retarget/file.h"
#include "retarget/hash.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 60, kHashDigits = 8;

bool is_name_letter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
}

bool is_gallery_name(std::string_view name) {
  if (name.size() < kHashDigits + 2 || name.size() > kLongestName + 1 + kHashDigits) return false;
  const std::string_view hash = name.substr(name.size() - kHashDigits);
  return name[name.size() - kHashDigits - 1] == '-' && std::ranges::all_of(name, is_name_letter) &&
         hash.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

Failure among_the_batch(const std::string& output) {
  return usage_failure("the gallery would be written among the batch's own files",
                       "give another folder, such as " + (fs::path(output) / "gallery").string());
}

}  // namespace

Result<std::string> gallery_name(const ManifestEntry& entry) {
  std::string name = entry.relative + "-" + entry.robot;
  RETARGET_TRY_ASSIGN(const std::string hash, hash_bytes(entry.relative + '\0' + entry.robot));
  for (char& letter : name) {
    if (!is_name_letter(letter)) letter = '_';
  }
  return name.substr(0, kLongestName) + "-" +
         hash.substr(std::string_view("sha256:").size(), kHashDigits);
}

Result<void> check_gallery_folder(const std::string& output, const BatchFolder& batch) {
  std::error_code ignored;
  if (!fs::exists(output, ignored)) return {};
  if (fs::equivalent(output, batch.folder, ignored)) return among_the_batch(output);
  for (const fs::path& file : files_in_folder(output)) {
    const std::string name = file.filename().string();
    if (name.starts_with("manifest") && name.ends_with(".jsonl")) return among_the_batch(output);
  }
  std::set<fs::path> folders;
  for (const ManifestEntry& entry : batch.entries) {
    for (const FileRecord& made : entry.outputs) {
      folders.insert((fs::path(batch.folder) / made.file).parent_path());
    }
    folders.insert(fs::absolute(entry.input.file, ignored).parent_path());
  }
  const fs::path pages = fs::path(output) / kGalleryPages;
  for (const fs::path& folder : folders) {
    if (!fs::exists(folder, ignored)) continue;
    if (fs::equivalent(folder, output, ignored) ||
        (fs::exists(pages, ignored) && is_below(folder, pages))) {
      return among_the_batch(output);
    }
  }
  return {};
}

void remove_stale_pages(const fs::path& pages, const std::set<std::string>& kept) {
  for (const fs::path& file : files_in_folder(pages)) {
    const std::string ending = file.extension().string();
    if (ending != ".html" && ending != ".png") continue;
    if (kept.contains(file.filename().string()) || !is_file(file)) continue;
    if (!is_gallery_name(file.stem().string())) continue;
    // Failure is harmless: no page links to the file.
    std::error_code ignored;
    fs::remove(file, ignored);
  }
}

}  // namespace retarget
