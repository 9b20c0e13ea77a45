#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/export.h"

// Link retarget::batch.
namespace RETARGET_API retarget {

/// Computes the SHA-256 of bytes that arrive in chunks (FIPS 180-4).
///
/// A hash is text, `sha256:` and 64 lower-case hexadecimal digits, so that it names its function.
/// Errors (kRun): finish() was called before.
class ContentHasher {
 public:
  [[nodiscard]] static Result<ContentHasher> create();
  ~ContentHasher();
  ContentHasher(ContentHasher&&) noexcept;
  ContentHasher& operator=(ContentHasher&&) noexcept;

  void update(std::string_view bytes);
  /// Returns the hash of all bytes. The object must not be used afterwards.
  [[nodiscard]] Result<std::string> finish();

 private:
  struct Digest;
  explicit ContentHasher(std::unique_ptr<Digest> digest);
  std::unique_ptr<Digest> digest_;
};

[[nodiscard]] Result<std::string> hash_bytes(std::string_view bytes);

/// Hashes the content of a regular file in chunks, with constant memory.
/// @param kind  kind of errors about the file: missing, unreadable, a folder, a pipe or a device
///   (reading would consume their bytes).
[[nodiscard]] Result<std::string> hash_file(const std::string& path,
                                            ErrorKind kind = ErrorKind::kInput);

}  // namespace retarget
