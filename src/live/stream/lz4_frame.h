#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// First byte of an LZ4 frame; the rest of the magic number is 22 4D 18.
inline constexpr char kLz4Mark = '\x04';

/// Decompresses LZ4 frames (the frame format, not raw blocks) incrementally. A build without the
/// library rejects them.
class Lz4Frame {
 public:
  Lz4Frame();
  ~Lz4Frame();
  Lz4Frame(Lz4Frame&&) noexcept;
  Lz4Frame& operator=(Lz4Frame&&) noexcept;

  /// Whether this build includes the library.
  [[nodiscard]] static bool is_available();

  /// Consumes the bytes of the frame from the front of `bytes` and appends the decompressed data to
  /// `text`, at most `max_size` in total regardless of the frame's header.
  /// @return whether the frame has ended. Errors (kInput): invalid frame, size limit exceeded, no
  ///   library; the next call then starts a new frame.
  [[nodiscard]] Result<bool> unpack(std::string_view& bytes, std::size_t max_size,
                                    std::string& text);
  /// Makes the next call start a new frame.
  void clear();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace retarget
