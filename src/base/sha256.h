#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace retarget {

/// SHA-256 of bytes that arrive in chunks (FIPS 180-4, section 6.2).
///
/// On x86-64 the processor's SHA instructions are used if it has them; the digest is the same.
class Sha256 {
 public:
  using Digest = std::array<std::uint8_t, 32>;

  void update(std::string_view bytes);
  /// Returns the digest of all bytes. The object must not be used afterwards.
  [[nodiscard]] Digest finish();

 private:
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> block_{};  // The first size_ % 64 bytes are not hashed yet.
  std::uint64_t size_ = 0;                // Size of all bytes so far.
};

/// The SHA-256 of bytes as 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view bytes);

/// The compression function of the standard on `count` blocks of 64 bytes, for Sha256 and its
/// tests.
using Sha256Blocks = void (*)(std::array<std::uint32_t, 8>& state, const std::uint8_t* blocks,
                              std::size_t count);
void sha256_blocks(std::array<std::uint32_t, 8>& state, const std::uint8_t* blocks,
                   std::size_t count);
/// Returns the compression function that uses the SHA instructions of x86-64; null on processors
/// without them.
[[nodiscard]] Sha256Blocks sha256_blocks_by_instructions();

}  // namespace retarget
