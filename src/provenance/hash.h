#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Finds the SHA-256 of bytes that come piece by piece (FIPS 180-4, by OpenSSL's libcrypto).
///
/// Hashes are text, `sha256:` and 64 lower-case hexadecimal digits, so that files that hold them
/// say which function they are of. Errors are of kind kRun: libcrypto could not do it, as where
/// its configuration switches SHA-256 off.
class ContentHasher {
 public:
  [[nodiscard]] static Result<ContentHasher> create();
  ~ContentHasher();
  ContentHasher(ContentHasher&&) noexcept;
  ContentHasher& operator=(ContentHasher&&) noexcept;

  void update(std::string_view bytes);
  /// The hash of all bytes so far; nothing may follow.
  [[nodiscard]] Result<std::string> finish();

 private:
  struct Digest;
  explicit ContentHasher(std::unique_ptr<Digest> digest);
  std::unique_ptr<Digest> digest_;
};

[[nodiscard]] Result<std::string> hash_bytes(std::string_view bytes);

/// The hash of a regular file's content, read in pieces: memory does not follow its size.
/// @param kind  of the errors about the file: not there, unreadable, a folder, a pipe or a device
///              (whose bytes would be lost to others).
[[nodiscard]] Result<std::string> hash_file(const std::string& path,
                                            ErrorKind kind = ErrorKind::kInput);

}  // namespace retarget
