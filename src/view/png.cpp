#include <zlib.h>

#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

#include "view/image.h"

namespace retarget {
namespace {

void append_big_endian(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((value >> shift) & 0xFF);
}

void append_chunk(std::string& file, const char* kind, std::string_view content) {
  append_big_endian(file, static_cast<std::uint32_t>(content.size()));
  const std::size_t checked = file.size();
  file.append(kind).append(content);
  const auto* first = reinterpret_cast<const Bytef*>(file.data() + checked);
  append_big_endian(
      file, static_cast<std::uint32_t>(crc32(0, first, static_cast<uInt>(file.size() - checked))));
}

// Returns the Paeth predictor: the neighbour nearest to left + above - corner.
int paeth(int left, int above, int corner) {
  const int guess = left + above - corner;
  const int to_left = std::abs(guess - left), to_above = std::abs(guess - above),
            to_corner = std::abs(guess - corner);
  if (to_left <= to_above && to_left <= to_corner) return left;
  return to_above <= to_corner ? above : corner;
}

// Applies one of PNG's five filters to a row; the filter number comes first.
// @return the sum of absolute values, as signed bytes (PNG filter heuristic).
long filter_row(std::span<const std::uint8_t> row, std::span<const std::uint8_t> above, int filter,
                std::string& result) {
  result[0] = static_cast<char>(filter);
  long weight = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const int left = i >= 3 ? row[i - 3] : 0, up = above[i], corner = i >= 3 ? above[i - 3] : 0;
    const int guess = filter == 1   ? left
                      : filter == 2 ? up
                      : filter == 3 ? (left + up) / 2
                      : filter == 4 ? paeth(left, up, corner)
                                    : 0;
    const auto rest = static_cast<signed char>(row[i] - guess);
    result[i + 1] = static_cast<char>(rest);
    weight += std::abs(rest);
  }
  return weight;
}

std::string filtered_rows(const Image& image) {
  const std::size_t width = 3 * static_cast<std::size_t>(image.width());
  const std::span<const std::uint8_t> bytes(image.bytes());
  const std::vector<std::uint8_t> nothing(width, 0);
  std::string rows, row(width + 1, '\0'), best;
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height()); ++y) {
    const auto above =
        y == 0 ? std::span<const std::uint8_t>(nothing) : bytes.subspan((y - 1) * width, width);
    long least = std::numeric_limits<long>::max();
    for (int filter = 0; filter < 5; ++filter) {
      const long weight = filter_row(bytes.subspan(y * width, width), above, filter, row);
      if (weight >= least) continue;
      least = weight;
      best = row;
    }
    rows += best;
  }
  return rows;
}

}  // namespace

std::string format_png(const Image& image) {
  std::string header;
  append_big_endian(header, static_cast<std::uint32_t>(image.width()));
  append_big_endian(header, static_cast<std::uint32_t>(image.height()));
  // Bit depth 8, RGB without alpha, the standard compression and filter methods, no interlacing.
  header += std::string("\x08\x02\x00\x00\x00", 5);
  const std::string rows = filtered_rows(image);
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  // Cannot fail: the buffer has the maximum compressed size.
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(rows.size()), 6);
  packed.resize(size);
  std::string file = "\x89PNG\r\n\x1a\n";
  append_chunk(file, "IHDR", header);
  append_chunk(file, "sRGB", std::string_view("\0", 1));
  append_chunk(file, "IDAT", packed);
  append_chunk(file, "IEND", {});
  return file;
}

}  // namespace retarget
