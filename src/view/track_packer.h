#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// Compresses bytes as one zlib stream, in base64.
[[nodiscard]] Result<std::string> packed_text(std::string_view bytes);

/// Encodes time series compactly for embedding in a page: rounded to a step, as differences between
/// frames, deflated.
///
/// Layout of a track: first one byte per channel, the order of differences (0 to 2); then four byte
/// planes, from the lowest byte to the highest, of channels x frames values, channel by channel. A
/// value v is stored unsigned: as 2v, or as -2v - 1 if negative. Differences and their sums wrap at
/// 32 bits, so they are exact.
class TrackPacker {
 public:
  struct Track {
    int channels = 0;
    int frames = 0;
    double step = 0.0;  ///< Values are multiples of this; the error is at most half of it.
  };

  /// Adds a track. Errors (kInput): a value that is not finite or more than a billion steps from 0.
  /// @param values  frame-major.
  /// @return its index in tracks().
  [[nodiscard]] Result<int> add(int channels, double step, std::span<const double> values);

  [[nodiscard]] const std::vector<Track>& tracks() const { return tracks_; }
  /// Packs all tracks in order with packed_text.
  [[nodiscard]] Result<std::string> finish() const { return packed_text(bytes_); }

 private:
  std::vector<Track> tracks_;
  std::string bytes_;
};

}  // namespace retarget
