#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/error.h"

namespace retarget {

/// Cuts the bytes of a connection into a protocol's messages, whose headers say how long they are.
class MessageCutter {
 public:
  /// The size of a message, header included, by the first bytes of it; nothing: none begins so.
  using SizeOf = std::optional<std::size_t> (*)(std::string_view header);

  /// @param header_size  bytes that size_of needs.
  MessageCutter(std::size_t header_size, SizeOf size_of)
      : header_size_(header_size), size_of_(size_of) {}

  /// Takes the next bytes, and gives each message that is whole to a function. What is wrong with one
  /// message is no fault of those behind it.
  /// @param take_message  Result<void>(std::string_view message)
  /// @return its first error, or one of bytes that begin no message.
  template <typename TakeMessage>
  [[nodiscard]] Result<void> take(std::string_view bytes, TakeMessage take_message) {
    Result<void> first;
    append(bytes);
    while (const auto message = next()) {
      Result<void> taken = take_message(*message);
      if (!taken && first) first = std::move(taken);
    }
    if (std::exchange(skipped_, 0) > 0 && first) {
      return input_failure({}, "bytes that begin no message of the protocol");
    }
    return first;
  }
  void clear();

 private:
  void append(std::string_view bytes);
  // the next message, valid until the next call; nothing: it has not come whole
  [[nodiscard]] std::optional<std::string_view> next();

  std::size_t header_size_;
  SizeOf size_of_;
  std::string waiting_;
  std::size_t taken_ = 0;
  std::size_t skipped_ = 0;  // bytes that began no message
};

}  // namespace retarget
