#include "base/sha256.h"

#include <gtest/gtest.h>

#include <string>

#include "retarget/text.h"

namespace retarget {
namespace {

std::string sha256_of(std::string_view bytes) {
  Sha256 hasher;
  hasher.update(bytes);
  const Sha256::Digest digest = hasher.finish();
  return hex_text(std::string(digest.begin(), digest.end()));
}

// Bytes whose period does not divide a block.
std::string sample_bytes(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * i % 251);
  return bytes;
}

// NIST's examples for FIPS 180-4: one block, two blocks, and 896 bits.
TEST(Sha256Test, MatchesTheExamplesOfTheStandard) {
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_of("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmn"
                      "hijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrstnopqrstu"),
            "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
}

// The hash of the hashes of all sizes around the borders of blocks and of the padding, from
// Python's hashlib.
TEST(Sha256Test, HashesEverySize) {
  std::string all;
  for (std::size_t size = 0; size <= 200; ++size) all += sha256_of(sample_bytes(size));
  EXPECT_EQ(sha256_of(all), "343b46658380ef96f439345e1de81859571aca0e9f6863d298197c50f31d8d3a");
}

TEST(Sha256Test, PiecesOfAnySizeGiveTheHashOfTheWhole) {
  const std::string bytes = sample_bytes(1000);
  const std::string whole = sha256_of(bytes);
  for (const std::size_t piece : {1, 3, 55, 56, 63, 64, 65, 127, 128, 500}) {
    Sha256 hasher;
    for (std::size_t i = 0; i < bytes.size(); i += piece)
      hasher.update(std::string_view(bytes).substr(i, piece));
    const Sha256::Digest digest = hasher.finish();
    EXPECT_EQ(hex_text(std::string(digest.begin(), digest.end())), whole) << piece;
  }
}

TEST(Sha256Test, InstructionsGiveTheSameStateAsTheStandardsFormulas) {
  const Sha256Blocks by_instructions = sha256_blocks_by_instructions();
  if (by_instructions == nullptr) GTEST_SKIP() << "this processor has no SHA instructions";
  const std::string bytes = sample_bytes(64 * 17);
  const auto* blocks = reinterpret_cast<const std::uint8_t*>(bytes.data());
  for (const std::size_t count : {0, 1, 2, 17}) {
    std::array<std::uint32_t, 8> formulas{1, 2, 3, 4, 5, 6, 7, 0xffffffff};
    std::array<std::uint32_t, 8> instructions = formulas;
    sha256_blocks(formulas, blocks, count);
    by_instructions(instructions, blocks, count);
    EXPECT_EQ(instructions, formulas) << count;
  }
}

}  // namespace
}  // namespace retarget
