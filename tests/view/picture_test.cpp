#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <string>
#include <vector>

#include "retarget/view.h"
#include "support/test_robots.h"
#include "view/image.h"
#include "view/render.h"

namespace retarget {
namespace {

// Pixels of a PNG of this library, decoded with zlib and the five filters of the format.
struct DecodedPng {
  std::uint32_t width = 0, height = 0;
  std::vector<int> bytes;

  [[nodiscard]] int at(std::uint32_t x, std::uint32_t y, std::uint32_t channel = 0) const {
    return bytes[3 * (y * width + x) + channel];
  }
};

std::uint32_t big_endian(const std::string& text, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value = 256 * value + static_cast<unsigned char>(text[at + i]);
  return value;
}

DecodedPng decode(const std::string& file) {
  DecodedPng png;
  EXPECT_EQ(file.substr(0, 8), "\x89PNG\r\n\x1a\n");
  std::string packed;
  for (std::size_t at = 8; at < file.size();) {
    const std::size_t size = big_endian(file, at);
    const std::string kind = file.substr(at + 4, 4), content = file.substr(at + 8, size);
    const auto* checked = reinterpret_cast<const Bytef*>(file.data() + at + 4);
    EXPECT_EQ(big_endian(file, at + 8 + size), crc32(0, checked, static_cast<uInt>(size + 4)));
    if (kind == "IHDR") {
      png.width = big_endian(content, 0);
      png.height = big_endian(content, 4);
    }
    if (kind == "IDAT") packed += content;
    at += 12 + size;
  }
  const std::size_t row = 3 * static_cast<std::size_t>(png.width);
  uLongf size = (row + 1) * png.height;
  std::vector<unsigned char> rows(size);
  EXPECT_EQ(uncompress(rows.data(), &size, reinterpret_cast<const Bytef*>(packed.data()),
                       static_cast<uLong>(packed.size())),
            Z_OK);
  EXPECT_EQ(size, rows.size());
  for (std::uint32_t y = 0; y < png.height; ++y) {
    const unsigned char* line = rows.data() + y * (row + 1);
    for (std::size_t i = 0; i < row; ++i) {
      const std::size_t here = y * row + i;
      const int left = i >= 3 ? png.bytes[here - 3] : 0;
      const int up = y > 0 ? png.bytes[here - row] : 0;
      const int corner = i >= 3 && y > 0 ? png.bytes[here - row - 3] : 0;
      const int guess = left + up - corner;
      const int a = std::abs(guess - left), b = std::abs(guess - up), c = std::abs(guess - corner);
      const int paeth = a <= b && a <= c ? left : b <= c ? up : corner;
      const int guesses[] = {0, left, up, (left + up) / 2, paeth};
      png.bytes.push_back((line[i + 1] + guesses[line[0]]) & 0xFF);
    }
  }
  return png;
}

Solid sphere(const Eigen::Vector3d& centre, double radius, int colour) {
  Solid solid;
  solid.colour = colour;
  solid.shape.centre = centre;
  solid.shape.radius = solid.shape.bounding_radius = radius;
  return solid;
}

// 200 by 200 pixels, 100 per metre, the world origin in the middle.
DecodedPng drawn(const SolidFigure& figure) {
  Image image(200, 200, 0xFFFFFF);
  render(figure, Camera(), {0, 0, 200, 200, {100.0, 100.0}, 100.0}, image);
  return decode(format_png(image));
}

bool is_paper(const DecodedPng& png, std::uint32_t x, std::uint32_t y) {
  return png.at(x, y, 0) == 255 && png.at(x, y, 1) == 255 && png.at(x, y, 2) == 255;
}

TEST(Png, KeepsEveryPixel) {
  Image image(37, 23, 0x102030);
  for (int y = 0; y < 23; ++y) {
    for (int x = 0; x < 37; ++x) {
      for (int i = 0; i < 3; ++i) {
        image.pixel(x, y)[i] = static_cast<std::uint8_t>((x * x * 7 + y * 31 + i * 85) % 256);
      }
    }
  }
  const DecodedPng png = decode(format_png(image));
  ASSERT_EQ(png.width, 37);
  ASSERT_EQ(png.height, 23);
  EXPECT_TRUE(std::ranges::equal(png.bytes, image.bytes()));
}

TEST(Render, DrawsShapesWithTheirPositionAndSize) {
  // Half a metre to the right and above the middle: 30 pixels around (150, 50).
  const DecodedPng png = drawn({sphere({0.5, 0.0, 0.5}, 0.304, 0xFF0000)});
  EXPECT_GT(png.at(150, 50, 0), 100);
  EXPECT_LT(png.at(150, 50, 1), 60);
  EXPECT_FALSE(is_paper(png, 178, 50));
  EXPECT_TRUE(is_paper(png, 182, 50));
  EXPECT_TRUE(is_paper(png, 150, 17));
  EXPECT_FALSE(is_paper(png, 150, 22));
  // A circle: its pixel count equals its area; half of the light is 181 of 255.
  int covered = 0;
  for (std::uint32_t y = 0; y < 90; ++y) {
    for (std::uint32_t x = 0; x < 200; ++x) covered += png.at(x, y, 1) < 181 ? 1 : 0;
  }
  EXPECT_NEAR(covered, 3.14159 * 924.16, 30.0);
  // Its edge is antialiased.
  bool between = false;
  for (std::uint32_t x = 176; x < 184; ++x) {
    between |= png.at(x, 50, 1) > 60 && png.at(x, 50, 1) < 250;
  }
  EXPECT_TRUE(between);
}

TEST(Render, TheNearerShapeHidesTheOther) {
  // The camera looks along +y.
  const Solid red = sphere({0.0, 0.4, 0.6}, 0.3, 0xFF0000),
              blue = sphere({0.0, -0.4, 0.6}, 0.2, 0x0000FF);
  for (const SolidFigure& figure : {SolidFigure{red, blue}, SolidFigure{blue, red}}) {
    const DecodedPng png = drawn(figure);
    EXPECT_GT(png.at(100, 40, 2), png.at(100, 40, 0));
    EXPECT_GT(png.at(126, 40, 0), png.at(126, 40, 2));
  }
}

TEST(Render, CapsulesAndBoxesHaveTheirOutline) {
  Solid capsule = sphere({0.0, 0.0, 0.5}, 0.1, 0x00FF00);
  capsule.shape.axis_count = 1;
  capsule.shape.half_axes[0] = {0.4, 0.0, 0.0};
  capsule.shape.bounding_radius = 0.5;
  const DecodedPng lying = drawn({capsule});
  EXPECT_FALSE(is_paper(lying, 52, 50));
  EXPECT_FALSE(is_paper(lying, 148, 50));
  EXPECT_TRUE(is_paper(lying, 48, 50));
  EXPECT_TRUE(is_paper(lying, 152, 50));
  EXPECT_FALSE(is_paper(lying, 100, 42));
  EXPECT_TRUE(is_paper(lying, 100, 38));
  EXPECT_TRUE(is_paper(lying, 52, 42));
  // Seen from its end it is a disc.
  capsule.shape.half_axes[0] = {0.0, 0.4, 0.0};
  const DecodedPng end = drawn({capsule});
  EXPECT_FALSE(is_paper(end, 108, 50));
  EXPECT_TRUE(is_paper(end, 112, 50));

  Solid box = sphere({0.0, 0.0, 0.5}, 0.0, 0x0000FF);
  box.shape.axis_count = 3;
  box.shape.half_axes = {Eigen::Vector3d(0.3, 0.0, 0.0), Eigen::Vector3d(0.0, 0.2, 0.0),
                         Eigen::Vector3d(0.0, 0.0, 0.1)};
  box.shape.bounding_radius = 0.4;
  const DecodedPng boxed = drawn({box});
  EXPECT_FALSE(is_paper(boxed, 71, 41));
  EXPECT_FALSE(is_paper(boxed, 128, 58));
  EXPECT_TRUE(is_paper(boxed, 131, 50));
  EXPECT_TRUE(is_paper(boxed, 100, 38));
}

TEST(Render, LightComesFromAboveAndCastsShadows) {
  const DecodedPng png = drawn({sphere({0.0, 0.0, 0.6}, 0.3, 0x808080)});
  EXPECT_GT(png.at(100, 18), png.at(100, 62) + 20);
  // Slightly from above, as in strips: the ground below a foot is darker than beside it.
  Image image(200, 200, 0xFFFFFF);
  render({sphere({0.0, 0.0, 0.1}, 0.1, 0x808080)}, Camera::beside({0.0, 1.0, 0.0}),
         {0, 0, 200, 200, {100.0, 100.0}, 100.0}, image);
  const DecodedPng standing = decode(format_png(image));
  EXPECT_LT(standing.at(100, 101), 240);
  EXPECT_EQ(standing.at(5, 103), 255);
  EXPECT_EQ(standing.at(100, 180), 255);
}

TEST(StripPicture, HasSizeAndPosesAndIsDeterministic) {
  const auto g1 = load_g1();
  const RobotClip clip(g1, FrameRate{30, 1}, 61);
  const std::string bytes = draw_strip_picture(clip, nullptr, {});
  EXPECT_EQ(bytes, draw_strip_picture(clip, nullptr, {}));
  const DecodedPng png = decode(bytes);
  EXPECT_NEAR(png.width, 1200, 1);
  // Six figures: occupied columns separated by empty ones.
  int figures = 0;
  bool inside = false;
  for (std::uint32_t x = 0; x < png.width; ++x) {
    bool drawn = false;
    for (std::uint32_t y = 0; y < png.height / 2; ++y) drawn |= png.at(x, y) < 200;
    if (drawn && !inside) ++figures;
    inside = drawn;
  }
  EXPECT_EQ(figures, 6);
  StripPictureOptions small;
  small.poses = 3;
  small.width = 240;
  small.times = false;
  const DecodedPng thumbnail = decode(draw_strip_picture(clip, nullptr, small));
  EXPECT_LE(thumbnail.width, 241);
  // One pose is no wider than its height allows.
  small.poses = 1;
  small.width = 5000;
  small.max_row_height = 100.0;
  EXPECT_LT(decode(draw_strip_picture(clip, nullptr, small)).height, 120);
}

TEST(StripPicture, SizeIsIndependentOfTheHeightOfTheMotion) {
  RobotClip clip(load_g1(), FrameRate{30, 1}, 7);
  StripPictureOptions small;
  small.width = 600;
  const DecodedPng standing = decode(draw_strip_picture(clip, nullptr, small));
  for (const double height : {100.0, 1e7, -100.0, 1e12}) {
    for (int i = 0; i < clip.frame_count(); ++i) clip.qpos(i)[2] = height;
    const DecodedPng high = decode(draw_strip_picture(clip, nullptr, small));
    EXPECT_LE(high.width, 601) << height;
    EXPECT_LE(high.height, 2 * standing.height) << height;
    // The picture contains the figures.
    if (std::abs(height) > 1e3) continue;
    EXPECT_NEAR(high.height, standing.height, 3) << height;
    EXPECT_TRUE(std::ranges::any_of(high.bytes, [](int value) { return value < 128; })) << height;
  }
}

}  // namespace
}  // namespace retarget
