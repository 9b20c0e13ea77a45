// SHA-256 with the SHA instructions of x86-64, selected at run time; baseline builds contain it as well.
//
// SHA256RNDS2 makes two rounds on the state in the order ABEF and CDGH; SHA256MSG1 and SHA256MSG2 are the two halves of the message
// schedule (Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2).

#include "base/sha256.h"

#if defined(__x86_64__) && defined(__GNUC__)

#include <cpuid.h>
#include <immintrin.h>

#define RETARGET_SHA __attribute__((target("sha,sse4.1,ssse3")))

namespace retarget {
namespace {

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

// GCC 12 does not know "sha" in __builtin_cpu_supports.
bool has_sha_instructions() {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return false;
  return (b >> 29 & 1) != 0 && __builtin_cpu_supports("sse4.1") != 0 &&
         __builtin_cpu_supports("ssse3") != 0;
}

}  // namespace

Sha256Blocks sha256_blocks_by_instructions() {
  return has_sha_instructions() ? blocks_by_instructions : nullptr;
}

}  // namespace retarget

#else

namespace retarget {

Sha256Blocks sha256_blocks_by_instructions() {
  return nullptr;
}

}  // namespace retarget

#endif
