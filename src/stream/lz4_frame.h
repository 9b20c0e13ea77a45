#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// The first byte of a frame of LZ4; the others of its mark are 22 4D 18.
inline constexpr char kLz4Mark = '\x04';

/// Unpacks frames of LZ4 (its frame format, not bare blocks) as their bytes come. A build without the
/// library refuses them.
class Lz4Frame {
 public:
  Lz4Frame();
  ~Lz4Frame();
  Lz4Frame(Lz4Frame&&) noexcept;
  Lz4Frame& operator=(Lz4Frame&&) noexcept;

  /// Whether this build has the library.
  [[nodiscard]] static bool is_available();

  /// Takes bytes from the front of `bytes`, as many as belong to the frame, and appends what is in them to
  /// `text`; no more than `max_size` in all, whatever the frame's header says.
  /// @return whether the frame has ended. Errors (kInput): no such frame, one that holds more, no library;
  ///     the next call begins a new frame.
  [[nodiscard]] Result<bool> unpack(std::string_view& bytes, std::size_t max_size,
                                    std::string& text);
  /// The next call begins a new frame.
  void clear();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace retarget
