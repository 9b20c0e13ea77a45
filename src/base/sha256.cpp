#include "base/sha256.h"

#include <algorithm>
#include <bit>

#include "retarget/text.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#include <immintrin.h>
#define RETARGET_SHA __attribute__((target("sha,sse4.1,ssse3")))
#endif

namespace retarget {
namespace {

// The constants K of the rounds: the first 32 bits of the fractions of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, 64> kSha256Constants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

constexpr std::size_t kSha256Block = 64;
constexpr std::size_t kSha256LengthBytes = 8;

std::uint32_t big_endian_word(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 |
         std::uint32_t{bytes[2]} << 8 | bytes[3];
}

void compress_block(std::array<std::uint32_t, 8>& state, const std::uint8_t* block) {
  std::array<std::uint32_t, 64> w;
  for (std::size_t t = 0; t < 16; ++t) w[t] = big_endian_word(block + 4 * t);
  for (std::size_t t = 16; t < 64; ++t) {
    const std::uint32_t early = w[t - 15];
    const std::uint32_t late = w[t - 2];
    const std::uint32_t sigma0 = std::rotr(early, 7) ^ std::rotr(early, 18) ^ early >> 3;
    const std::uint32_t sigma1 = std::rotr(late, 17) ^ std::rotr(late, 19) ^ late >> 10;
    w[t] = sigma1 + w[t - 7] + sigma0 + w[t - 16];
  }
  auto [a, b, c, d, e, f, g, h] = state;
  for (std::size_t t = 0; t < 64; ++t) {
    const std::uint32_t sum1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t sum0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t choice = (e & f) ^ (~e & g);
    const std::uint32_t majority = (a & b) ^ (a & c) ^ (b & c);
    const std::uint32_t temporary = h + sum1 + choice + kSha256Constants[t] + w[t];
    h = g;
    g = f;
    f = e;
    e = d + temporary;
    d = c;
    c = b;
    b = a;
    a = temporary + sum0 + majority;
  }
  const std::array<std::uint32_t, 8> after{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < state.size(); ++i) state[i] += after[i];
}

void compress(std::array<std::uint32_t, 8>& state, const std::uint8_t* blocks, std::size_t count) {
  static const Sha256Blocks by_instructions = sha256_blocks_by_instructions();
  (by_instructions != nullptr ? by_instructions : sha256_blocks)(state, blocks, count);
}

// The SHA instructions of x86-64, selected at run time; baseline builds contain them as well.
//
// SHA256RNDS2 makes two rounds on the state in the order ABEF and CDGH; SHA256MSG1 and SHA256MSG2 are the two halves of the message
// schedule (Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2).
#ifdef RETARGET_SHA

RETARGET_SHA __m128i load_four(const void* from) {
  return _mm_loadu_si128(static_cast<const __m128i*>(from));
}

RETARGET_SHA void blocks_by_instructions(std::array<std::uint32_t, 8>& state,
                                         const std::uint8_t* blocks, std::size_t count) {
  const __m128i to_words = _mm_set_epi64x(0x0c0d0e0f08090a0b, 0x0405060700010203);
  const __m128i cdab = _mm_shuffle_epi32(load_four(state.data()), 0xb1);
  const __m128i efgh = _mm_shuffle_epi32(load_four(state.data() + 4), 0x1b);
  __m128i abef = _mm_alignr_epi8(cdab, efgh, 8);
  __m128i cdgh = _mm_blend_epi16(efgh, cdab, 0xf0);
  for (std::size_t block = 0; block < count; ++block, blocks += 64) {
    const __m128i abef_before = abef;
    const __m128i cdgh_before = cdgh;
    __m128i w[4];  // the last sixteen words of the message schedule
    for (std::size_t group = 0; group < 16; ++group) {
      __m128i& words = w[group % 4];
      if (group < 4) {
        words = _mm_shuffle_epi8(load_four(blocks + 16 * group), to_words);
      } else {
        const __m128i last = w[(group + 3) % 4];
        const __m128i seven_before = _mm_alignr_epi8(last, w[(group + 2) % 4], 4);
        words = _mm_sha256msg1_epu32(words, w[(group + 1) % 4]);
        words = _mm_sha256msg2_epu32(_mm_add_epi32(words, seven_before), last);
      }
      const __m128i sum = _mm_add_epi32(words, load_four(kSha256Constants.data() + 4 * group));
      cdgh = _mm_sha256rnds2_epu32(cdgh, abef, sum);
      abef = _mm_sha256rnds2_epu32(abef, cdgh, _mm_shuffle_epi32(sum, 0x0e));
    }
    abef = _mm_add_epi32(abef, abef_before);
    cdgh = _mm_add_epi32(cdgh, cdgh_before);
  }
  const __m128i feba = _mm_shuffle_epi32(abef, 0x1b);
  const __m128i dchg = _mm_shuffle_epi32(cdgh, 0xb1);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data()), _mm_blend_epi16(feba, dchg, 0xf0));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data() + 4), _mm_alignr_epi8(dchg, feba, 8));
}

// GCC 12 does not support "sha" in __builtin_cpu_supports.
bool has_sha_instructions() {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return false;
  return (b >> 29 & 1) != 0 && __builtin_cpu_supports("sse4.1") != 0 &&
         __builtin_cpu_supports("ssse3") != 0;
}

#endif

}  // namespace

Sha256Blocks sha256_blocks_by_instructions() {
#ifdef RETARGET_SHA
  if (has_sha_instructions()) return blocks_by_instructions;
#endif
  return nullptr;
}

void sha256_blocks(std::array<std::uint32_t, 8>& state, const std::uint8_t* blocks,
                   std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) compress_block(state, blocks + kSha256Block * i);
}

void Sha256::update(std::string_view bytes) {
  const auto* next = reinterpret_cast<const std::uint8_t*>(bytes.data());
  std::size_t left = bytes.size();
  const std::size_t waiting = size_ % kSha256Block;
  size_ += left;
  if (waiting > 0) {
    const std::size_t taken = std::min(left, kSha256Block - waiting);
    std::copy_n(next, taken, block_.begin() + static_cast<std::ptrdiff_t>(waiting));
    next += taken;
    left -= taken;
    if (waiting + taken < kSha256Block) return;
    compress(state_, block_.data(), 1);
  }
  compress(state_, next, left / kSha256Block);
  std::copy_n(next + left / kSha256Block * kSha256Block, left % kSha256Block, block_.begin());
}

// Padding: a one bit, zeros, and the size in bits as the last 64 bits of a block.
Sha256::Digest Sha256::finish() {
  const std::uint64_t bits = size_ * 8;
  std::size_t filled = size_ % kSha256Block;
  block_[filled++] = 0x80;
  if (filled > kSha256Block - kSha256LengthBytes) {
    std::fill(block_.begin() + static_cast<std::ptrdiff_t>(filled), block_.end(), std::uint8_t{0});
    compress(state_, block_.data(), 1);
    filled = 0;
  }
  std::fill(block_.begin() + static_cast<std::ptrdiff_t>(filled), block_.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < kSha256LengthBytes; ++i) {
    block_[kSha256Block - 1 - i] = static_cast<std::uint8_t>(bits >> 8 * i);
  }
  compress(state_, block_.data(), 1);
  Digest digest;
  for (std::size_t i = 0; i < digest.size(); ++i) {
    digest[i] = static_cast<std::uint8_t>(state_[i / 4] >> (24 - 8 * (i % 4)));
  }
  return digest;
}

std::string sha256_hex(std::string_view bytes) {
  Sha256 hash;
  hash.update(bytes);
  const Sha256::Digest digest = hash.finish();
  return hex_text(std::string(digest.begin(), digest.end()));
}

}  // namespace retarget
