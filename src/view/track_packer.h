#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// Bytes as one zlib stream, in base64.
[[nodiscard]] Result<std::string> packed_text(std::string_view bytes);

/// Numbers over time in few bytes, for a page that has to carry them: rounded to a step, as
/// differences from frame to frame, deflated.
///
/// A track's bytes: for each channel one that says how often differences were taken (0 to 2), then
/// four planes, from the lowest byte to the highest, of channels x frames values, channel by channel.
/// A value v is stored without a sign: 2v, or -2v - 1 where it is negative. Differences and what
/// undoes them wrap at 32 bits, so nothing is lost.
class TrackPacker {
 public:
  struct Track {
    int channels = 0;
    int frames = 0;
    double step = 0.0;  ///< A value is a multiple of it; off by half of it at most.
  };

  /// Errors (kInput): a value that is not finite or more than a billion steps from 0.
  /// @param values  frame-major.
  /// @return its place in tracks().
  [[nodiscard]] Result<int> add(int channels, double step, std::span<const double> values);

  [[nodiscard]] const std::vector<Track>& tracks() const { return tracks_; }
  /// All tracks, one after the other, as packed_text.
  [[nodiscard]] Result<std::string> finish() const { return packed_text(bytes_); }

 private:
  std::vector<Track> tracks_;
  std::string bytes_;
};

}  // namespace retarget
