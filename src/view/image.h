#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {

/// An image of 8-bit sRGB pixels, row by row from the top.
class Image {
 public:
  Image(int width, int height, int colour);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  /// Returns the red, green and blue of a pixel. @pre The pixel is inside the image.
  [[nodiscard]] std::uint8_t* pixel(int x, int y) {
    return bytes_.data() + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                static_cast<std::size_t>(x));
  }

 private:
  int width_, height_;
  std::vector<std::uint8_t> bytes_;
};

/// Draws digits, full stops, blanks and the letter s as lines; other characters become blanks.
/// @param middle  centre of the text's baseline, pixels.
/// @param height  height of a digit, pixels.
void draw_time(Image& image, std::string_view text, const Eigen::Vector2d& middle, double height,
               int colour);

/// Encodes a PNG (ISO/IEC 15948): 8-bit RGB, with the filter per row that minimises the sum of
/// absolute values, compressed by zlib.
[[nodiscard]] std::string format_png(const Image& image);

}  // namespace retarget
