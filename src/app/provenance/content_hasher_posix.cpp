// SHA-256 of OpenSSL's libcrypto.

#include <openssl/evp.h>

#include <array>
#include <memory>
#include <utility>

#include "retarget/hash.h"
#include "retarget/text.h"

namespace retarget {
namespace {

Failure hash_failure() {
  return run_failure("", "libcrypto cannot compute a SHA-256",
                     "its configuration may disable this function");
}

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

}  // namespace retarget
