// Number line reader in SSE4.1, selected at run time; baseline builds contain it as well.
//
// Every block of 64 bytes takes two steps. First, a bit mask marks blanks, which gives the bounds
// of all numbers without inspecting single bytes. Then each number of any length is converted by
// the same instructions: a load of the 16 bytes that end with the number puts the last digit in the
// last byte; a mask clears the bytes before the number, a byte shuffle removes the point, and three
// multiply-adds turn the digits into two integers below 10^8. Mantissa and power of ten are exact
// as doubles, so their quotient is rounded once, as in parse_number.
//
// The masks follow Langdale and Lemire, "Parsing gigabytes of JSON per second" (VLDB Journal 28,
// 2019), the multiply-adds Mula, "Parsing series of integers with SIMD" (2018).

#if defined(__x86_64__) && defined(__GNUC__)

#include <smmintrin.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <string_view>

#include "formats/bvh/number_parser.h"
#include "formats/bvh/source_text.h"

#define RETARGET_SSE41 __attribute__((target("sse4.1")))

namespace retarget {
namespace {

constexpr std::size_t kBlock = 64;
// Digits and point. A mantissa of at most 15 digits is exact.
constexpr std::size_t kMaxLength = 15;
// Index of the point in 16 bytes without one.
constexpr std::size_t kNoPoint = 16;

struct alignas(16) Bytes : std::array<std::uint8_t, 16> {};

// One object, so that one register can address all tables.
struct Tables {
  // By length: keeps that many bytes at the end.
  std::array<Bytes, kMaxLength + 1> keep{};
  // By index of the point: closes its gap. A point in the last byte stays and fails the digit
  // check, so `5.` and a lone point go to the slow reader.
  std::array<Bytes, kNoPoint + 1> close_point{};
  // By index of the point: power of ten, first for positive, then for negative numbers.
  std::array<std::array<double, 32>, 2> divisor{};
};

constexpr Tables make_tables() {
  constexpr std::uint8_t kZero = 0x80;
  Tables tables;
  for (std::size_t length = 0; length <= kMaxLength; ++length) {
    for (std::size_t i = 0; i < 16; ++i) tables.keep[length][i] = i >= 16 - length ? 0xff : 0;
  }
  for (std::size_t point = 0; point <= kNoPoint; ++point) {
    for (std::uint8_t i = 0; i < 16; ++i) {
      const bool before = i <= point && point < 15;
      tables.close_point[point][i] = !before  ? i
                                     : i == 0 ? kZero
                                              : static_cast<std::uint8_t>(i - 1);
    }
    double power = 1.0;
    for (std::size_t i = point; i < 15; ++i) power *= 10.0;
    tables.divisor[0][point] = power;
    tables.divisor[1][point] = -power;
  }
  return tables;
}

constexpr Tables kTables = make_tables();

inline __m128i load(const char* bytes) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes));
}

inline __m128i load(const Bytes& bytes) {
  return _mm_load_si128(reinterpret_cast<const __m128i*>(bytes.data()));
}

// One bit for each of the 64 bytes.
struct BlockMasks {
  std::uint64_t blank = 0;    // Not part of a number: space and all lower codes.
  std::uint64_t control = 0;  // Below space: line ends, tabs, invalid control bytes.
};

inline BlockMasks mask_block(const char* block) {
  const __m128i space = _mm_set1_epi8(' ');
  const __m128i last_control = _mm_set1_epi8(' ' - 1);
  const auto at_most = [](__m128i bytes, __m128i limit) {
    return static_cast<unsigned>(
        _mm_movemask_epi8(_mm_cmpeq_epi8(_mm_min_epu8(bytes, limit), bytes)));
  };
  BlockMasks masks;
  for (unsigned i = 0; i < kBlock; i += 16) {
    const __m128i bytes = load(block + i);
    masks.blank |= std::uint64_t{at_most(bytes, space)} << i;
    masks.control |= std::uint64_t{at_most(bytes, last_control)} << i;
  }
  return masks;
}

// Index of the line end in this block, kBlock if there is none, npos at an invalid control byte.
inline std::size_t find_line_end(const char* block, std::uint64_t control) {
  for (; control != 0; control &= control - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(control));
    if (is_line_end(block[i])) return i;
    if (!is_space(block[i])) return std::string_view::npos;
  }
  return kBlock;
}

// Not inlined, so that the converter stays in registers.
[[gnu::noinline]] ParsedNumber parse_long_number(const char* begin, const char* end) {
  return parse_number(begin, end);
}

// Converts numbers into a row. Validity is checked once, at the end of the line.
class Converter {
 public:
  Converter(const char* text_end, double* out) : text_end_(text_end), out_(out) {}

  RETARGET_SSE41 inline void convert(const char* begin, const char* end) {
    // 1 for `-`, computed without a branch, which would be mispredicted half the time.
    const std::size_t negative = ((static_cast<unsigned char>(*begin) ^ unsigned{'-'}) - 1U) >> 31;
    const std::size_t length = static_cast<std::size_t>(end - begin) - negative;
    if (length - 1 >= kMaxLength) [[unlikely]] {
      const ParsedNumber slow = parse_long_number(begin, text_end_);
      all_numbers_ = all_numbers_ && slow.status == NumberStatus::kOk && slow.end == end;
      *out_++ = slow.value;
      return;
    }
    // '0' to '9' become 0 to 9; all other bytes become larger than 9.
    const __m128i text = _mm_xor_si128(load(end - 16), _mm_set1_epi8('0'));
    const __m128i number = _mm_and_si128(text, load(kTables.keep[length]));
    const auto points =
        static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(number, _mm_set1_epi8('.' ^ '0'))));
    const auto point = static_cast<std::size_t>(std::countr_zero(points | 1U << kNoPoint));
    const __m128i digits = _mm_shuffle_epi8(number, load(kTables.close_point[point]));
    not_digits_ = _mm_or_si128(not_digits_, _mm_subs_epu8(digits, _mm_set1_epi8(9)));

    // Combine digits into groups of two, four and eight.
    const __m128i pairs = _mm_maddubs_epi16(digits, _mm_set1_epi16(0x010a));
    const __m128i fours = _mm_madd_epi16(pairs, _mm_set1_epi32(0x00010064));
    const __m128i eights =
        _mm_madd_epi16(_mm_packus_epi32(fours, fours), _mm_set1_epi32(0x00012710));
    const __m128d halves = _mm_mul_pd(_mm_cvtepi32_pd(eights), _mm_set_pd(1.0, 1e8));
    const __m128d mantissa = _mm_add_sd(halves, _mm_unpackhi_pd(halves, halves));
    *out_++ = _mm_cvtsd_f64(mantissa) / kTables.divisor[negative][point];
  }

  RETARGET_SSE41 bool all_numbers() const {
    return all_numbers_ && _mm_testz_si128(not_digits_, not_digits_) != 0;
  }
  const double* out() const { return out_; }

 private:
  const char* text_end_;
  double* out_;
  __m128i not_digits_ = _mm_setzero_si128();
  bool all_numbers_ = true;
};

RETARGET_SSE41 std::size_t read_number_line_sse41(std::string_view text, std::size_t begin,
                                                  std::size_t count, std::span<double> row) {
  constexpr std::size_t kDeclined = std::string_view::npos;
  // The conversion loads the 16 bytes that end with the first number.
  if (begin < 16) return kDeclined;
  const char* const text_end = text.data() + text.size();
  const double* const row_end = row.data() + count;
  Converter converter(text_end, row.data());
  std::uint64_t blank_before = 1;
  const char* number = nullptr;  // A number that began in the previous block.
  for (const char* block = text.data() + begin;; block += kBlock) {
    if (text_end - block < static_cast<std::ptrdiff_t>(kBlock)) return kDeclined;
    auto [blank, control] = mask_block(block);
    const std::size_t line_end = control == 0 ? kBlock : find_line_end(block, control);
    if (line_end == kDeclined) return kDeclined;
    if (line_end < kBlock) blank |= ~std::uint64_t{0} << line_end;

    const std::uint64_t edges = blank ^ (blank << 1 | blank_before);
    blank_before = blank >> 63;
    std::uint64_t begins = edges & ~blank;
    std::uint64_t ends = edges & blank;
    if (number != nullptr && ends != 0) {
      converter.convert(number, block + std::countr_zero(ends));
      ends &= ends - 1;
      number = nullptr;
    }
    for (; ends != 0; ends &= ends - 1, begins &= begins - 1) {
      converter.convert(block + std::countr_zero(begins), block + std::countr_zero(ends));
    }
    if (begins != 0) number = block + std::countr_zero(begins);
    // A block holds at most kNumberLineSlack numbers.
    if (converter.out() > row_end) return kDeclined;
    if (line_end == kBlock) continue;
    const bool good = converter.out() == row_end && converter.all_numbers();
    return good ? static_cast<std::size_t>(block - text.data()) + line_end : kDeclined;
  }
}

}  // namespace

ReadNumberLine vector_number_line_reader() {
  return __builtin_cpu_supports("sse4.1") != 0 ? read_number_line_sse41 : nullptr;
}

}  // namespace retarget

#else

namespace retarget {

ReadNumberLine vector_number_line_reader() {
  return nullptr;
}

}  // namespace retarget

#endif
