#pragma once

#include <cstdint>
#include <string>

namespace retarget {

/// An exact frame rate: `frames` frames in `seconds` seconds, both positive, in lowest terms.
///
/// Times of frames are rational numbers, so nothing drifts however long a clip is.
struct FrameRate {
  std::int64_t frames = 30;
  std::int64_t seconds = 1;

  [[nodiscard]] double fps() const { return static_cast<double>(frames) / seconds; }
  /// Duration of one frame in seconds.
  [[nodiscard]] double frame_time() const { return static_cast<double>(seconds) / frames; }
  /// Time of a frame in seconds; frame 0 is at 0.
  [[nodiscard]] double time_of(std::int64_t frame) const {
    return static_cast<double>(frame * seconds) / static_cast<double>(frames);
  }

  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};

/// The rate meant by a positive, finite frames-per-second number.
///
/// A whole number N when the value is within 1e-4 of it, relatively (so the 0.033333 that many
/// files say means 30 exactly); otherwise the simplest fraction within 1e-9 of the value
/// (23.976 becomes 2997/125).
[[nodiscard]] FrameRate frame_rate_from_fps(double fps);

/// The rate meant by a positive, finite `Frame Time` in seconds; rules as frame_rate_from_fps.
[[nodiscard]] FrameRate frame_rate_from_frame_time(double frame_time);

/// Whether two rates differ by no more than 1e-4, relatively: then frames are copied one by one.
[[nodiscard]] bool same_rate(const FrameRate& a, const FrameRate& b);

/// `30`, or with up to eight significant digits `23.976`.
[[nodiscard]] std::string to_text(const FrameRate& rate);

}  // namespace retarget
