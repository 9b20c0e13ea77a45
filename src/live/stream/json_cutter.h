#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "live/stream/lz4_frame.h"
#include "retarget/error.h"

namespace retarget {

/// Splits bytes into consecutive JSON objects, plain or each in an LZ4 frame. The bytes may arrive
/// in pieces, as from a connection.
class JsonCutter {
 public:
  /// Starts a packet; limits the bytes decompressed from its LZ4 frames.
  void begin_packet(std::size_t most_unpacked) { unpacked_left_ = most_unpacked; }
  /// Consumes bytes from the front of `bytes`, up to the end of the next object.
  /// @return its text, valid until the next call; nothing if all bytes are consumed and no object
  ///   is complete. Errors (kInput): bytes that start no object, which are skipped, and objects of
  ///   more than a megabyte.
  /// @pre bytes is not empty
  [[nodiscard]] Result<std::optional<std::string_view>> next(std::string_view& bytes);
  /// Whether an object is incomplete.
  [[nodiscard]] bool is_inside() const { return inside_ != Inside::kNothing; }
  void clear();

 private:
  enum class Inside : unsigned char { kNothing, kObject, kFrame };
  [[nodiscard]] bool take_object(std::string_view& bytes);

  Inside inside_ = Inside::kNothing;
  std::string text_;
  int depth_ = 0;
  bool in_text_ = false, escaped_ = false;  // State within the object.
  std::size_t unpacked_left_ = std::size_t{1} << 20;
  Lz4Frame frame_;
};

}  // namespace retarget
