#include <zlib.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <span>
#include <utility>

#include "view/image.h"

namespace retarget {
namespace {

using Points = std::vector<Eigen::Vector2d>;

// Strokes of a digit in a box of 4 by 6, relative to its lower left corner.
const std::vector<Points>& strokes_of(char letter) {
  static const std::vector<std::pair<char, std::vector<Points>>> kLetters = {
      {'0',
       {{{2, 0},
         {0.8, 0.6},
         {0.4, 2},
         {0.4, 4},
         {0.8, 5.4},
         {2, 6},
         {3.2, 5.4},
         {3.6, 4},
         {3.6, 2},
         {3.2, 0.6},
         {2, 0}}}},
      {'1', {{{0.9, 4.8}, {2.2, 6}, {2.2, 0}}}},
      {'2',
       {{{0.5, 4.8}, {1, 5.7}, {2, 6}, {3.1, 5.6}, {3.5, 4.6}, {3.1, 3.4}, {0.4, 0}, {3.6, 0}}}},
      {'3',
       {{{0.5, 5.2}, {1.2, 5.9}, {2.2, 6}, {3.2, 5.5}, {3.4, 4.5}, {2.9, 3.5}, {1.7, 3.2}},
        {{1.7, 3.2}, {3.1, 2.8}, {3.6, 1.7}, {3.1, 0.5}, {2, 0}, {1, 0.2}, {0.4, 1}}}},
      {'4', {{{2.9, 0}, {2.9, 6}, {0.3, 1.8}, {3.8, 1.8}}}},
      {'5',
       {{{3.3, 6},
         {0.9, 6},
         {0.6, 3.3},
         {1.6, 3.8},
         {2.6, 3.7},
         {3.4, 3},
         {3.6, 1.9},
         {3.2, 0.7},
         {2.1, 0},
         {1, 0.2},
         {0.4, 0.9}}}},
      {'6',
       {{{3.2, 5.4},
         {2.2, 6},
         {1.1, 5.4},
         {0.5, 3.9},
         {0.4, 2},
         {0.9, 0.5},
         {2, 0},
         {3.2, 0.5},
         {3.6, 1.8},
         {3.2, 3.1},
         {2.1, 3.6},
         {1, 3.1},
         {0.5, 2.2}}}},
      {'7', {{{0.4, 6}, {3.6, 6}, {1.5, 0}}}},
      {'8',
       {{{2, 3.2},
         {0.9, 3.8},
         {0.7, 4.9},
         {1.3, 5.8},
         {2, 6},
         {2.7, 5.8},
         {3.3, 4.9},
         {3.1, 3.8},
         {2, 3.2},
         {0.8, 2.6},
         {0.4, 1.5},
         {0.9, 0.4},
         {2, 0},
         {3.1, 0.4},
         {3.6, 1.5},
         {3.2, 2.6},
         {2, 3.2}}}},
      {'9',
       {{{0.8, 0.6},
         {1.8, 0},
         {2.9, 0.6},
         {3.5, 2.1},
         {3.6, 4},
         {3.1, 5.5},
         {2, 6},
         {0.8, 5.5},
         {0.4, 4.2},
         {0.8, 2.9},
         {1.9, 2.4},
         {3, 2.9},
         {3.5, 3.8}}}},
      {'.', {{{0.7, 0}, {0.7, 0.15}}}},
      {'-', {{{0.6, 2.6}, {2.8, 2.6}}}},
      {'s',
       {{{2.9, 3.3},
         {1.9, 3.9},
         {0.8, 3.6},
         {0.6, 2.8},
         {1.2, 2.2},
         {2.3, 1.8},
         {3, 1.2},
         {2.8, 0.4},
         {1.7, 0},
         {0.5, 0.6}}}}};
  static const std::vector<Points> kBlank;
  for (const auto& [known, strokes] : kLetters) {
    if (known == letter) return strokes;
  }
  return kBlank;
}

double advance_of(char letter) {
  if (letter == '.') return 2.1;
  return letter == ' ' ? 2.4 : 4.9;
}

double distance_to(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double share =
      std::clamp((p - a).dot(along) / std::max(1e-12, along.squaredNorm()), 0.0, 1.0);
  return (p - a - share * along).norm();
}

// Draws a line with round ends and a soft edge of one pixel.
void draw_stroke(Image& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double radius,
                 int colour) {
  const Eigen::Vector2d reach(radius + 1.0, radius + 1.0);
  const Eigen::Vector2d low = a.cwiseMin(b) - reach, high = a.cwiseMax(b) + reach;
  const int left = std::max(0, static_cast<int>(std::floor(low.x())));
  const int top = std::max(0, static_cast<int>(std::floor(low.y())));
  const int right = std::min(image.width() - 1, static_cast<int>(std::ceil(high.x())));
  const int bottom = std::min(image.height() - 1, static_cast<int>(std::ceil(high.y())));
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      const double away = distance_to({x + 0.5, y + 0.5}, a, b);
      const double cover = std::clamp(radius + 0.5 - away, 0.0, 1.0);
      std::uint8_t* pixel = image.pixel(x, y);
      for (int i = 0; i < 3; ++i) {
        const int wanted = (colour >> (16 - 8 * i)) & 0xFF;
        // Take the minimum so that crossing lines do not darken each other.
        const double mixed = 255.0 + cover * (wanted - 255.0);
        pixel[i] = static_cast<std::uint8_t>(std::min<double>(pixel[i], std::floor(mixed + 0.5)));
      }
    }
  }
}

}  // namespace

Image::Image(int width, int height, int colour) : width_(width), height_(height) {
  bytes_.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int i = 0; i < width * height; ++i) {
    for (int shift = 16; shift >= 0; shift -= 8) {
      bytes_.push_back(static_cast<std::uint8_t>((colour >> shift) & 0xFF));
    }
  }
}

void draw_time(Image& image, std::string_view text, const Eigen::Vector2d& middle, double height,
               int colour) {
  const double scale = height / 6.0;
  double width = 0.0;
  for (const char letter : text) width += scale * advance_of(letter);
  double x = middle.x() - 0.5 * width;
  for (const char letter : text) {
    const auto pixel_of = [&](const Eigen::Vector2d& point) {
      return Eigen::Vector2d(x + scale * (point.x() + 0.4), middle.y() - scale * point.y());
    };
    for (const Points& stroke : strokes_of(letter)) {
      for (std::size_t i = 1; i < stroke.size(); ++i) {
        draw_stroke(image, pixel_of(stroke[i - 1]), pixel_of(stroke[i]), 0.36 * scale, colour);
      }
    }
    x += scale * advance_of(letter);
  }
}

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
