#include "base/sha256.h"

#include <algorithm>
#include <bit>

namespace retarget {

constexpr std::array<std::uint32_t, 64> kSha256Constants = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

namespace {

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

}  // namespace

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

// The padding: a one bit, zeros, and the size in bits as the last 64 bits of a block.
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

}  // namespace retarget
