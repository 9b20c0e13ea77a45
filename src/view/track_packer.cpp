#include "view/track_packer.h"

#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "retarget/bytes.h"

namespace retarget {
namespace {

using Words = std::vector<std::uint32_t>;

// Maps signed to unsigned values such that values near 0 stay small (zigzag encoding).
std::uint32_t folded(std::uint32_t value) {
  return (value << 1U) ^ ((value & 0x80000000U) != 0 ? 0xFFFFFFFFU : 0U);
}

Words differences(const Words& values) {
  Words result(values.size());
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    result[i] = values[i] - before;
    before = values[i];
  }
  return result;
}

std::size_t bits_of(const Words& values) {
  std::size_t bits = 0;
  for (const std::uint32_t value : values) bits += std::bit_width(folded(value));
  return bits;
}

struct PackedChannel {
  Words values;
  char order = 0;  // Number of times that differences were taken.
};

PackedChannel packed(Words values) {
  PackedChannel best{std::move(values), 0};
  std::size_t fewest = bits_of(best.values);
  Words next = best.values;
  for (char order = 1; order <= 2; ++order) {
    next = differences(next);
    const std::size_t bits = bits_of(next);
    if (bits >= fewest) continue;
    fewest = bits;
    best = {next, order};
  }
  return best;
}

}  // namespace

Result<std::string> packed_text(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string deflated(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(deflated.data()), &size,
                             reinterpret_cast<const Bytef*>(bytes.data()),
                             static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
  if (code != Z_OK) return run_failure("", "zlib cannot compress the page data: out of memory");
  deflated.resize(size);
  return base64_text(deflated);
}

Result<int> TrackPacker::add(int channels, double step, std::span<const double> values) {
  constexpr double kMaxSteps = 1e9;
  const auto wide = static_cast<std::size_t>(channels);
  const std::size_t frames = channels > 0 ? values.size() / wide : 0;
  std::string orders;
  std::array<std::string, 4> planes;
  for (std::size_t channel = 0; channel < wide; ++channel) {
    Words rounded(frames);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      const double steps = std::nearbyint(values[frame * wide + channel] / step);
      // Negated comparison: NaN fails too.
      if (!(std::abs(steps) <= kMaxSteps)) {
        return input_failure(
            "", "frame " + std::to_string(frame) + " has a position too far away to display");
      }
      rounded[frame] = static_cast<std::uint32_t>(static_cast<std::int32_t>(steps));
    }
    const PackedChannel each = packed(std::move(rounded));
    orders += each.order;
    for (const std::uint32_t value : each.values) {
      const std::uint32_t word = folded(value);
      for (std::size_t i = 0; i < planes.size(); ++i) {
        planes[i] += static_cast<char>((word >> (8U * i)) & 0xFFU);
      }
    }
  }
  bytes_ += orders;
  for (const std::string& plane : planes) bytes_ += plane;
  tracks_.push_back({channels, static_cast<int>(frames), step});
  return static_cast<int>(tracks_.size()) - 1;
}

}  // namespace retarget
