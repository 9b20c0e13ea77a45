#include "retarget/hash.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include "base/sha256.h"
#include "base/try.h"
#include "retarget/os.h"
#include "retarget/text.h"

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
    if (descriptor >= 0) os::close_file(descriptor);
  }
};

}  // namespace

Result<std::string> hash_bytes(std::string_view bytes) {
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  hasher.update(bytes);
  return hasher.finish();
}

Result<std::string> hash_file(const std::string& path, ErrorKind kind) {
  const OpenFile file{os::open_file(path, os::OpenFor::kReadingAtOnce)};
  if (file.descriptor < 0) return file_failure(kind, path, errno);
  const auto info = os::status_of(file.descriptor);
  if (!info) return file_failure(kind, path, errno);
  if (info->kind == os::EntryKind::kFolder) return file_failure(kind, path, EISDIR);
  if (info->kind != os::EntryKind::kRegular) {
    return failure({kind, {path, 0, 0}, "expected a regular file, found a device or pipe", {}, {}});
  }
  TRY_ASSIGN(auto hasher, ContentHasher::create());
  const auto piece = std::make_unique_for_overwrite<char[]>(kPiece);
  for (;;) {
    const std::int64_t count = os::read_bytes(file.descriptor, piece.get(), kPiece);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return file_failure(kind, path, errno);
    if (count == 0) break;
    hasher.update({piece.get(), static_cast<std::size_t>(count)});
  }
  return hasher.finish();
}

struct ContentHasher::Digest {
  Sha256 sha256;
  bool is_finished = false;
};

ContentHasher::ContentHasher(std::unique_ptr<Digest> digest) : digest_(std::move(digest)) {}
ContentHasher::~ContentHasher() = default;
ContentHasher::ContentHasher(ContentHasher&&) noexcept = default;
ContentHasher& ContentHasher::operator=(ContentHasher&&) noexcept = default;

Result<ContentHasher> ContentHasher::create() {
  return ContentHasher(std::make_unique<Digest>());
}

void ContentHasher::update(std::string_view bytes) {
  digest_->sha256.update(bytes);
}

Result<std::string> ContentHasher::finish() {
  if (digest_->is_finished) return run_failure("", "the hash of these bytes was already taken", "");
  digest_->is_finished = true;
  const Sha256::Digest digest = digest_->sha256.finish();
  return "sha256:" + hex_text(std::string(digest.begin(), digest.end()));
}

}  // namespace retarget
