#include <algorithm>
#include <cerrno>
#include <optional>
#include <system_error>

#include "base/try.h"
#include "retarget/file.h"
#include "retarget/os.h"

namespace retarget {
namespace {

std::string system_message(int error_number) {
  return std::generic_category().message(error_number);
}

std::string shown_input(const std::string& path) {
  return path == "-" ? "standard input" : path;
}

Failure read_failure(ErrorKind kind, const std::string& path, int error_number) {
  return failure({kind,
                  {shown_input(path), 0, 0},
                  "cannot read the file: " + system_message(error_number),
                  {},
                  error_number == EISDIR ? "give a file in it" : ""});
}

Failure write_failure(const std::string& name, int error_number) {
  const bool is_stream = name == "-";
  std::string hint;
  if (os::is_out_of_space(error_number)) {
    if (!is_stream) hint = "no partial file remains; ";
    hint += "free some space or write elsewhere";
  }
  return run_failure(is_stream ? "standard output" : name,
                     "cannot write the file: " + system_message(error_number), hint);
}

Failure too_large_failure(ErrorKind kind, const std::string& path, std::size_t max,
                          std::string_view hint) {
  return failure({kind,
                  {shown_input(path), 0, 0},
                  "expected at most " + std::to_string(max) + " bytes, found more",
                  {},
                  std::string(hint)});
}

// Closes the descriptor on every return path unless it is standard input.
struct Reader {
  int descriptor;
  bool owned;
  ~Reader() {
    if (owned) os::close_file(descriptor);
  }
};

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

// Resolves symbolic links. The final file may not exist: a link can dangle.
std::string follow_links(const std::string& path) {
  constexpr int kMaxLinks = 40;
  std::filesystem::path target = path;
  std::error_code error;
  for (int i = 0; i < kMaxLinks; ++i) {
    const auto next = std::filesystem::read_symlink(target, error);
    if (error) break;
    // operator/ replaces the folder when the link is absolute.
    target = target.parent_path() / next;
  }
  return target.string();
}

constexpr int kMaxNames = 1000;
constexpr std::string_view kTemporaryBegin = ".retarget-";
constexpr std::string_view kTemporaryEnd = ".tmp";

// Gives an unnamed file a name that is not taken. Returns 0, or -1 with errno.
int link_to_new_name(int descriptor, const std::string& target, std::string& name) {
  for (int number = 0; number < kMaxNames; ++number) {
    name = temporary_path(target, number);
    if (os::name_file(descriptor, name) == 0) return 0;
    if (errno != EEXIST) break;
  }
  name.clear();
  return -1;
}

// Creates a new empty file next to the target, for file systems without unnamed files.
int create_named(const std::string& target, std::string& name) {
  for (int number = 0; number < kMaxNames; ++number) {
    name = temporary_path(target, number);
    const int descriptor = os::open_file(name, os::OpenFor::kCreating);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

}  // namespace

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

std::vector<std::filesystem::path> files_in_folder(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    files.push_back(at->path());
  }
  std::ranges::sort(files);
  return files;
}

Result<FileContent> read_file(const std::string& path, ErrorKind kind, std::size_t max,
                              std::string_view too_large) {
  const bool standard_input = path == "-";
  Reader reader{standard_input ? os::kStandardInput : os::open_file(path, os::OpenFor::kReading),
                !standard_input};
  if (reader.descriptor < 0) return read_failure(kind, path, errno);
  auto info = os::status_of(reader.descriptor);
  if (!info) {
    if (!standard_input) return read_failure(kind, path, errno);
    // Wine reads a file as standard input, but does not describe it.
    info.emplace();
  }
  if (info->kind == os::EntryKind::kFolder) return read_failure(kind, path, EISDIR);
  // A device such as /dev/zero may never end.
  if (info->kind == os::EntryKind::kDevice && !standard_input) {
    return failure({kind, {path, 0, 0}, "expected a regular file, found a device", {}, {}});
  }

  const bool regular = info->kind == os::EntryKind::kRegular;
  if (regular && info->bytes > max) {
    return too_large_failure(kind, path, max, too_large);
  }

  // The size only saves copies: the file may be a pipe, or grow while it is read.
  std::size_t room = regular ? static_cast<std::size_t>(info->bytes) + 1 : 65536;
  auto bytes = std::make_unique_for_overwrite<char[]>(room);
  std::size_t used = 0;
  for (;;) {
    if (used == room) {
      auto grown = std::make_unique_for_overwrite<char[]>(2 * room);
      std::copy_n(bytes.get(), used, grown.get());
      bytes = std::move(grown);
      room *= 2;
    }
    const std::int64_t count = os::read_bytes(reader.descriptor, bytes.get() + used, room - used);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return read_failure(kind, path, errno);
    if (count == 0) break;
    used += static_cast<std::size_t>(count);
    if (used > max) return too_large_failure(kind, path, max, too_large);
  }
  return FileContent(std::move(bytes), used);
}

Result<void> check_readable(const std::string& path, ErrorKind kind) {
  const int descriptor = os::open_file(path, os::OpenFor::kReading);
  if (descriptor < 0) return read_failure(kind, path, errno);
  os::close_file(descriptor);
  return {};
}

Result<void> check_output_folder(const std::string& path) {
  if (path == "-") return {};
  const std::string folder = folder_of(path);
  std::error_code ignored;
  if (path.empty()) return usage_failure("the output name is empty");
  if (std::filesystem::is_directory(folder, ignored)) return {};
  if (std::filesystem::exists(folder, ignored)) {
    return usage_failure("\"" + folder + "\" of the output \"" + path + "\" is not a folder");
  }
  return usage_failure(
      "the folder \"" + folder + "\" of the output \"" + path + "\" does not exist",
      "create it first: mkdir -p " + folder);
}

Result<OutputFile> OutputFile::create(const std::string& path) {
  OutputFile file;
  file.path_ = path;
  if (path == "-") {
    file.descriptor_ = os::kStandardOutput;
    file.direct_ = true;
    return file;
  }
  TRY(check_output_folder(path));
  std::optional<unsigned> permissions;  // Those of the file that is replaced.
  if (const auto info = os::status_of(path)) {
    if (info->kind == os::EntryKind::kFolder) {
      return usage_failure("the output \"" + path + "\" is a folder", "give a file name");
    }
    file.direct_ = info->kind != os::EntryKind::kRegular;
    // rename() needs only the folder's permission, so respect a read-only file explicitly.
    if (!file.direct_ && !os::may_write(path)) return write_failure(path, errno);
    permissions = info->permissions;
  } else if (errno != ENOENT) {
    return write_failure(path, errno);
  }
  if (file.direct_) {
    file.descriptor_ = os::open_file(path, os::OpenFor::kWriting);
    if (file.descriptor_ < 0) return write_failure(path, errno);
    return file;
  }

  // Keep a symbolic link and replace the file that it points to.
  file.target_ = follow_links(path);
  TRY(check_output_folder(file.target_));

  file.descriptor_ = os::create_unnamed(folder_of(file.target_));
  if (file.descriptor_ < 0) {
    file.descriptor_ = create_named(file.target_, file.temporary_);
    if (file.descriptor_ < 0) {
      const int error_number = errno;
      file.temporary_.clear();
      return write_failure(path, error_number);
    }
  }
  if (permissions && os::set_permissions(file.descriptor_, *permissions) != 0) {
    return write_failure(path, errno);
  }
  return file;
}

OutputFile::~OutputFile() {
  discard();
}

OutputFile::OutputFile(OutputFile&& other) noexcept {
  *this = std::move(other);
}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  if (this == &other) return *this;
  discard();
  path_ = std::move(other.path_);
  target_ = std::move(other.target_);
  temporary_ = std::exchange(other.temporary_, {});
  descriptor_ = std::exchange(other.descriptor_, -1);
  direct_ = other.direct_;
  return *this;
}

void OutputFile::discard() {
  if (descriptor_ >= 0 && path_ != "-") os::close_file(descriptor_);
  descriptor_ = -1;
  if (!temporary_.empty()) os::remove_file(temporary_);
  temporary_.clear();
}

Result<void> OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::int64_t count = os::write_bytes(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int error_number = errno;
      // The caller may go on, but must not be able to commit half a file.
      discard();
      return write_failure(path_, error_number);
    }
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

Result<void> OutputFile::commit() {
  if (descriptor_ < 0) return write_failure(path_, EBADF);
  if (direct_) {
    discard();
    return {};
  }
  if (os::flush_to_disk(descriptor_) != 0) return write_failure(path_, errno);
  if (temporary_.empty()) {
    // Only rename() replaces a file atomically, and it needs a named source in the same folder.
    if (link_to_new_name(descriptor_, target_, temporary_) != 0) {
      return write_failure(path_, errno);
    }
  }
  if (os::move_over(temporary_, target_) != 0) return write_failure(path_, errno);
  temporary_.clear();
  discard();
  return {};
}

std::string os::without_last_separators(std::string path) {
  while (path.size() > 1 && kSeparators.find(path.back()) != std::string_view::npos) {
    path.pop_back();
  }
  return path;
}

std::string temporary_path(const std::string& target, int number) {
  return folder_of(target) + "/" + std::string(kTemporaryBegin) + std::to_string(os::process_id()) +
         "-" + std::to_string(number) + std::string(kTemporaryEnd);
}

bool is_temporary_name(std::string_view name) {
  if (!name.starts_with(kTemporaryBegin) || !name.ends_with(kTemporaryEnd)) return false;
  // Require two numbers in between, since names of other programs may have the same ends.
  name.remove_prefix(kTemporaryBegin.size());
  name.remove_suffix(std::min(kTemporaryEnd.size(), name.size()));
  const std::size_t middle = name.find('-');
  const auto is_number = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  return middle != std::string_view::npos && is_number(name.substr(0, middle)) &&
         is_number(name.substr(middle + 1));
}

Result<void> write_file(const std::string& path, std::string_view bytes) {
  TRY_ASSIGN(auto file, OutputFile::create(path));
  TRY(file.write(bytes));
  return file.commit();
}

namespace fs = std::filesystem;

bool is_plain_name(std::string_view name) {
  const auto is_control = [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  };
  return !name.empty() && name != "." && name != ".." &&
         name.find_first_of("/\\") == std::string_view::npos &&
         name.find_first_of(os::kNotInNames) == std::string_view::npos &&
         std::ranges::none_of(name, is_control);
}

bool is_plain_path(std::string_view path) {
  // System calls would stop at a zero byte and use another path.
  if (path.empty() || path.find('\0') != std::string_view::npos) return false;
  if (path.find_first_of(os::kNotInNames) != std::string_view::npos) return false;
  const fs::path parts(path);
  // On Windows, a path may be relative although it starts at the root of a drive.
  return !parts.has_root_path() && std::ranges::find(parts, "..") == parts.end() &&
         parts.lexically_normal() != ".";
}

bool is_below(const fs::path& file, const fs::path& folder) {
  std::error_code of_file, of_folder;
  const fs::path found = fs::weakly_canonical(file, of_file);
  const fs::path root = fs::weakly_canonical(folder, of_folder);
  if (of_file || of_folder) return false;
  return std::ranges::mismatch(root, found).in1 == root.end();
}

bool lies_in(const fs::path& folder, std::string_view path) {
  std::error_code error;
  return is_plain_path(path) && fs::exists(folder, error) &&
         is_below(folder / fs::path(path), folder);
}

}  // namespace retarget
