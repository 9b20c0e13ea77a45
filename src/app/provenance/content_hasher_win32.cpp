// SHA-256 of Windows (CNG, bcrypt.dll).

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX 1
#include <windows.h>

#include <bcrypt.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "retarget/hash.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kDigestBytes = 32;

Failure hash_failure() {
  return run_failure("", "Windows cannot compute a SHA-256",
                     "its configuration may disable this function");
}

}  // namespace

struct ContentHasher::Digest {
  BCRYPT_ALG_HANDLE algorithm = nullptr;
  BCRYPT_HASH_HANDLE hash = nullptr;
  bool sound = false;  // No call has failed so far.

  Digest() = default;
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;
  ~Digest() {
    if (hash != nullptr) ::BCryptDestroyHash(hash);
    if (algorithm != nullptr) ::BCryptCloseAlgorithmProvider(algorithm, 0);
  }
};

ContentHasher::ContentHasher(std::unique_ptr<Digest> digest) : digest_(std::move(digest)) {}
ContentHasher::~ContentHasher() = default;
ContentHasher::ContentHasher(ContentHasher&&) noexcept = default;
ContentHasher& ContentHasher::operator=(ContentHasher&&) noexcept = default;

Result<ContentHasher> ContentHasher::create() {
  auto digest = std::make_unique<Digest>();
  digest->sound =
      ::BCryptOpenAlgorithmProvider(&digest->algorithm, BCRYPT_SHA256_ALGORITHM, nullptr, 0) == 0 &&
      ::BCryptCreateHash(digest->algorithm, &digest->hash, nullptr, 0, nullptr, 0, 0) == 0;
  if (!digest->sound) return hash_failure();
  return ContentHasher(std::move(digest));
}

void ContentHasher::update(std::string_view bytes) {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  while (digest_->sound && !bytes.empty()) {
    const std::string_view piece = bytes.substr(0, kMost);
    // The function only reads them.
    auto* const begin = reinterpret_cast<unsigned char*>(const_cast<char*>(piece.data()));
    digest_->sound =
        ::BCryptHashData(digest_->hash, begin, static_cast<ULONG>(piece.size()), 0) == 0;
    bytes.remove_prefix(piece.size());
  }
}

Result<std::string> ContentHasher::finish() {
  std::array<unsigned char, kDigestBytes> value{};
  if (!digest_->sound ||
      ::BCryptFinishHash(digest_->hash, value.data(), static_cast<ULONG>(value.size()), 0) != 0) {
    return hash_failure();
  }
  digest_->sound = false;
  return "sha256:" + hex_text(std::string(value.begin(), value.end()));
}

}  // namespace retarget
