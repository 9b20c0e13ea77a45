#include "batch/manifest.h"

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <system_error>
#include <tuple>

#include "retarget/file.h"
#include "retarget/option_name.h"
#include "retarget/os.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

Failure manifest_failure(const std::string& path, int error_number) {
  return run_failure(path,
                     "cannot write the manifest: " + std::generic_category().message(error_number),
                     os::is_out_of_space(error_number)
                         ? "free some space and continue with " RETARGET_OPTION("resume")
                         : "");
}

// The first name of an entry that leads out of its folder.
std::optional<std::string> name_outside(const ManifestEntry& entry) {
  if (!is_plain_path(entry.relative)) return entry.relative;
  for (const std::string* name :
       {&entry.variant.source, &entry.variant.mirror_of, &entry.variant.varied_of}) {
    if (!name->empty() && !is_plain_path(*name)) return *name;
  }
  if (!entry.robot.empty() && !is_plain_name(entry.robot)) return entry.robot;
  const auto outside = std::ranges::find_if_not(
      entry.outputs, [](const FileRecord& output) { return is_plain_path(output.file); });
  return outside == entry.outputs.end() ? std::nullopt : std::optional(outside->file);
}

void take_line(std::string_view line, ManifestContent& content) {
  auto entry = parse_manifest_line(line);
  if (!entry) {
    ++content.unreadable;
  } else if (auto name = name_outside(*entry)) {
    if (content.outside++ == 0) content.outside_name = std::move(*name);
  } else {
    content.entries.push_back(std::move(*entry));
  }
}

}  // namespace

Result<ManifestContent> read_manifest(const std::string& path) {
  ManifestContent content;
  if (!os::status_of(path) && errno == ENOENT) return content;
  RETARGET_TRY_ASSIGN(const auto file, read_file(path, ErrorKind::kRun));
  std::string_view text = file.view();
  while (!text.empty()) {
    if (const auto line = take_until(text, '\n'); !line.empty()) take_line(line, content);
  }
  return content;
}

std::vector<ManifestEntry> latest_entries(std::vector<ManifestEntry> entries) {
  const auto name = [](const ManifestEntry& entry) {
    return std::tie(entry.relative, entry.robot);
  };
  std::ranges::stable_sort(entries, {}, &ManifestEntry::finished);
  std::ranges::stable_sort(entries, {}, name);
  std::vector<ManifestEntry> latest;
  for (ManifestEntry& entry : entries) {
    if (!latest.empty() && name(latest.back()) == name(entry)) {
      latest.back() = std::move(entry);
    } else {
      latest.push_back(std::move(entry));
    }
  }
  return latest;
}

struct ManifestWriter::State {
  std::string path;
  int descriptor = -1;
  std::mutex mutex;
};

ManifestWriter::ManifestWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}

ManifestWriter::~ManifestWriter() {
  if (state_->descriptor >= 0) os::close_file(state_->descriptor);
}

Result<std::unique_ptr<ManifestWriter>> ManifestWriter::begin(
    const std::string& path, std::span<const ManifestEntry> entries) {
  std::string text;
  for (const ManifestEntry& entry : entries) text += manifest_line(entry);
  RETARGET_TRY(write_file(path, text));
  auto state = std::make_unique<State>();
  state->path = path;
  state->descriptor = os::open_file(path, os::OpenFor::kAppending);
  if (state->descriptor < 0) return manifest_failure(path, errno);
  return std::unique_ptr<ManifestWriter>(new ManifestWriter(std::move(state)));
}

Result<void> ManifestWriter::append(const ManifestEntry& entry) {
  const std::string line = manifest_line(entry);
  {
    const std::lock_guard lock(state_->mutex);
    const std::int64_t end = os::seek_end(state_->descriptor);
    std::string_view rest = line;
    while (!rest.empty()) {
      const std::int64_t count = os::write_bytes(state_->descriptor, rest.data(), rest.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) {
        const int error_number = errno;
        if (end >= 0 && os::resize_file(state_->descriptor, end) != 0) {
          // A truncated line remains; readers skip it.
        }
        return manifest_failure(state_->path, error_number);
      }
      rest.remove_prefix(static_cast<std::size_t>(count));
    }
  }
  // Outside the lock, so that one flush can cover lines of several threads.
  if (os::flush_to_disk(state_->descriptor, true) != 0)
    return manifest_failure(state_->path, errno);
  return {};
}

}  // namespace retarget
