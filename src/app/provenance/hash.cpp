#include "retarget/hash.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <memory>
#include <system_error>
#include <utility>

#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;

Failure hash_failure() {
  return run_failure("", "libcrypto cannot compute a SHA-256",
                     "its configuration may disable this function");
}

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

struct ContentHasher::Digest {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  bool sound = false;  // No call has failed so far.

  Digest() = default;
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;
  ~Digest() { EVP_MD_CTX_free(context); }
};

ContentHasher::ContentHasher(std::unique_ptr<Digest> digest) : digest_(std::move(digest)) {}
ContentHasher::~ContentHasher() = default;
ContentHasher::ContentHasher(ContentHasher&&) noexcept = default;
ContentHasher& ContentHasher::operator=(ContentHasher&&) noexcept = default;

Result<ContentHasher> ContentHasher::create() {
  auto digest = std::make_unique<Digest>();
  digest->sound =
      digest->context != nullptr && EVP_DigestInit_ex(digest->context, EVP_sha256(), nullptr) == 1;
  if (!digest->sound) return hash_failure();
  return ContentHasher(std::move(digest));
}

void ContentHasher::update(std::string_view bytes) {
  digest_->sound =
      digest_->sound && EVP_DigestUpdate(digest_->context, bytes.data(), bytes.size()) == 1;
}

Result<std::string> ContentHasher::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> value;
  unsigned size = 0;
  if (!digest_->sound || EVP_DigestFinal_ex(digest_->context, value.data(), &size) != 1) {
    return hash_failure();
  }
  digest_->sound = false;
  const std::string digest(value.begin(), value.begin() + size);
  return "sha256:" + hex_text(digest);
}

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
