#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "stream/lz4_frame.h"

namespace retarget {

/// Cuts bytes into JSON objects: one after the other, as they are or each in a frame of LZ4. They may come in
/// pieces, as connections give them.
class JsonCutter {
 public:
  /// Takes bytes from the front of `bytes`, up to the end of the next object.
  /// @return its text, valid until the next call; nothing: all bytes are taken and none has ended.
  ///     Errors (kInput): bytes that begin none, which are skipped, and objects of more than a megabyte.
  /// @pre bytes are there
  [[nodiscard]] Result<std::optional<std::string_view>> next(std::string_view& bytes);
  /// Whether an object has begun and not ended.
  [[nodiscard]] bool is_inside() const { return inside_ != Inside::kNothing; }
  void clear();

 private:
  enum class Inside : unsigned char { kNothing, kObject, kFrame };
  [[nodiscard]] bool take_object(std::string_view& bytes);

  Inside inside_ = Inside::kNothing;
  std::string text_;
  int depth_ = 0;
  bool in_text_ = false, escaped_ = false;  // of the object
  Lz4Frame frame_;
};

}  // namespace retarget
