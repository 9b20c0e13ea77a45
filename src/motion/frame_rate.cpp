#include "retarget/clip.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>

namespace retarget {
namespace {

constexpr double kSnapTolerance = 1e-4;
constexpr double kFractionTolerance = 1e-9;
// Keeps products of a frame number and a rate within 64 bits.
constexpr std::int64_t kMaxTerm = 1'000'000'000;

// The simplest fraction near a positive value, by its continued fraction.
FrameRate simplest_fraction(double value) {
  std::int64_t num_before = 0, num = 1, den_before = 1, den = 0;
  double rest = value;
  for (int term = 0; term < 40; ++term) {
    const double whole = std::floor(rest);
    const double next_num = whole * static_cast<double>(num) + static_cast<double>(num_before);
    const double next_den = whole * static_cast<double>(den) + static_cast<double>(den_before);
    if (next_num > kMaxTerm || next_den > kMaxTerm) break;
    num_before = std::exchange(num, static_cast<std::int64_t>(next_num));
    den_before = std::exchange(den, static_cast<std::int64_t>(next_den));
    const double error = std::abs(static_cast<double>(num) / den - value);
    if (num > 0 && error <= kFractionTolerance * value) break;
    if (rest == whole) break;
    rest = 1.0 / (rest - whole);
  }
  // Clamps rates beyond the range of 64-bit time arithmetic.
  if (den == 0) return {kMaxTerm, 1};
  if (num == 0) return {1, kMaxTerm};
  return {num, den};
}

}  // namespace

FrameRate frame_rate_from_fps(double fps) {
  const double whole = std::round(fps);
  if (whole >= 1.0 && whole <= kMaxTerm && std::abs(fps / whole - 1.0) <= kSnapTolerance) {
    return {static_cast<std::int64_t>(whole), 1};
  }
  return simplest_fraction(fps);
}

FrameRate frame_rate_from_frame_time(double frame_time) {
  const double whole = std::round(1.0 / frame_time);
  if (whole >= 1.0 && whole <= kMaxTerm && std::abs(frame_time * whole - 1.0) <= kSnapTolerance) {
    return {static_cast<std::int64_t>(whole), 1};
  }
  return simplest_fraction(1.0 / frame_time);
}

bool same_rate(const FrameRate& a, const FrameRate& b) {
  return std::abs(a.fps() / b.fps() - 1.0) <= kSnapTolerance;
}

std::string to_text(const FrameRate& rate) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), rate.fps(),
                                          std::chars_format::general, 8);
  return {text.data(), error == std::errc() ? end : text.data()};
}

}  // namespace retarget
