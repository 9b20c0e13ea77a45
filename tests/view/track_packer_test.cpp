#include "view/scene_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "retarget/bytes.h"

namespace retarget {
namespace {

// Unpacks like the page's script (viewer/src/decode.js), implemented from the description in the
// header.
std::vector<double> unpacked(const std::string& bytes, std::size_t& at,
                             const TrackPacker::Track& track) {
  const auto channels = static_cast<std::size_t>(track.channels);
  const auto frames = static_cast<std::size_t>(track.frames);
  const std::size_t plane = channels * frames;
  std::vector<double> values(plane);
  const auto byte = [&](std::size_t index) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes.at(at + index)));
  };
  for (std::size_t channel = 0; channel < channels; ++channel) {
    std::vector<std::uint32_t> words(frames);
    for (std::size_t frame = 0; frame < frames; ++frame) {
      std::uint32_t folded = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        folded |= byte(channels + i * plane + channel * frames + frame) << (8 * i);
      }
      words[frame] = (folded >> 1U) ^ (0U - (folded & 1U));
    }
    for (std::uint32_t order = byte(channel); order > 0; --order) {
      for (std::size_t frame = 1; frame < frames; ++frame) words[frame] += words[frame - 1];
    }
    for (std::size_t frame = 0; frame < frames; ++frame) {
      values[frame * channels + channel] =
          static_cast<double>(std::bit_cast<std::int32_t>(words[frame])) * track.step;
    }
  }
  at += channels + 4 * plane;
  return values;
}

std::string inflated(const std::string& text) {
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    group = group << 6U | static_cast<std::uint32_t>(kDigits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(group >> static_cast<unsigned>(bits) & 0xFFU);
  }
  std::string result(1 << 22, '\0');
  uLongf size = result.size();
  EXPECT_EQ(
      uncompress(reinterpret_cast<Bytef*>(result.data()), &size,
                 reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size())),
      Z_OK);
  result.resize(size);
  return result;
}

TEST(TrackPacker, ErrorIsAtMostHalfAStep) {
  constexpr int kChannels = 5, kFrames = 400;
  constexpr std::array kSteps = {1e-4, 2e-5};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  std::vector<double> values;
  for (int i = 0; i < kFrames; ++i) {
    // At rest, along a line, swinging, noise, and jumps from one end to the other.
    const double t = i / 30.0;
    values.insert(values.end(), {0.123456789, -3.0 + 0.7 * t, std::sin(3.0 * t), noise(random),
                                 i % 2 == 0 ? 9e3 : -9e3});
  }
  TrackPacker packer;
  for (const double step : kSteps) ASSERT_TRUE(packer.add(kChannels, step, values));
  const std::string bytes = inflated(packer.finish().value());
  std::size_t at = 0;
  for (const TrackPacker::Track& track : packer.tracks()) {
    EXPECT_EQ(track.channels, kChannels);
    EXPECT_EQ(track.frames, kFrames);
    const std::vector<double> found = unpacked(bytes, at, track);
    ASSERT_EQ(found.size(), values.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      worst = std::max(worst, std::abs(found[i] - values[i]));
    }
    EXPECT_LE(worst, 0.5 * track.step * (1.0 + 1e-6));
    // The stated error is not pessimistic.
    EXPECT_GT(worst, 0.4 * track.step);
  }
  EXPECT_EQ(at, bytes.size());
}

TEST(TrackPacker, SmoothMotionTakesFewBytes) {
  constexpr int kFrames = 1800;
  std::vector<double> values;
  for (int i = 0; i < kFrames; ++i) {
    for (int joint = 0; joint < 30; ++joint) {
      values.push_back(std::sin(0.05 * i + joint) + 0.2 * std::sin(0.31 * i));
    }
  }
  TrackPacker packer;
  ASSERT_TRUE(packer.add(30, 1e-4, values));
  EXPECT_LT(packer.finish().value().size(), 2 * values.size());
}

TEST(TrackPacker, RejectsInvalidMotions) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), -2e5, 1e300}) {
    TrackPacker packer;
    const auto added = packer.add(1, 1e-4, std::vector<double>{0.0, 1.0, bad});
    ASSERT_FALSE(added) << bad;
    EXPECT_EQ(added.error().kind, ErrorKind::kInput);
    EXPECT_THAT(added.error().message, testing::HasSubstr("frame 2"));
  }
}

TEST(TrackPacker, PacksAnEmptyMotion) {
  TrackPacker packer;
  ASSERT_TRUE(packer.add(0, 1e-4, {}));
  ASSERT_TRUE(packer.add(3, 1e-4, {}));
  EXPECT_EQ(inflated(packer.finish().value()).size(), 3U);
}

TEST(Base64, MatchesTheStandard) {
  // RFC 4648, section 10
  EXPECT_EQ(base64_text(""), "");
  EXPECT_EQ(base64_text("f"), "Zg==");
  EXPECT_EQ(base64_text("fo"), "Zm8=");
  EXPECT_EQ(base64_text("foo"), "Zm9v");
  EXPECT_EQ(base64_text("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_text("\xFB\xFF\xFE"), "+//+");
}

}  // namespace
}  // namespace retarget
