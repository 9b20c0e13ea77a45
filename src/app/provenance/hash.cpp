#include "retarget/hash.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <system_error>

#include "base/try.h"

namespace retarget {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;

Failure file_failure(ErrorKind kind, const std::string& path, int error_number) {
  const std::string reason = std::generic_category().message(error_number);
  return failure({kind, {path, 0, 0}, "cannot read the file: " + reason, {}, {}});
}

struct OpenFile {
  int descriptor;
  ~OpenFile() {
    if (descriptor >= 0) ::close(descriptor);
  }
};

}  // namespace

Result<std::string> hash_bytes(std::string_view bytes) {
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  hasher.update(bytes);
  return hasher.finish();
}

Result<std::string> hash_file(const std::string& path, ErrorKind kind) {
  // O_NONBLOCK, because opening a pipe without a writer would block.
  const OpenFile file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct stat info {};
  if (file.descriptor < 0 || ::fstat(file.descriptor, &info) != 0) {
    return file_failure(kind, path, errno);
  }
  if (S_ISDIR(info.st_mode)) return file_failure(kind, path, EISDIR);
  if (!S_ISREG(info.st_mode)) return file_failure(kind, path, ENODEV);
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  const auto piece = std::make_unique_for_overwrite<char[]>(kPiece);
  for (;;) {
    const ssize_t count = ::read(file.descriptor, piece.get(), kPiece);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return file_failure(kind, path, errno);
    if (count == 0) break;
    hasher.update({piece.get(), static_cast<std::size_t>(count)});
  }
  return hasher.finish();
}

}  // namespace retarget
