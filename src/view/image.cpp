#include "view/image.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

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

}  // namespace retarget
