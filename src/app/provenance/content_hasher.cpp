#include <memory>
#include <string>
#include <utility>

#include "base/sha256.h"
#include "retarget/hash.h"
#include "retarget/text.h"

namespace retarget {

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
