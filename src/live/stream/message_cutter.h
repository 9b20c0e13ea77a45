#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/error.h"

namespace retarget {

/// Splits the bytes of a connection into a protocol's messages, whose headers contain their size.
class MessageCutter {
 public:
  /// Size of a message including its header, from its first bytes; nothing if they are not a valid
  /// header.
  using SizeOf = std::optional<std::size_t> (*)(std::string_view header);

  /// @param header_size  number of bytes that size_of needs.
  MessageCutter(std::size_t header_size, SizeOf size_of)
      : header_size_(header_size), size_of_(size_of) {}

  /// Adds the next bytes and passes each complete message to a function. An error in one message
  /// does not affect the following ones.
  /// @param take_message  Result<void>(std::string_view message)
  /// @return the first error of take_message, or an error for bytes that start no message.
  template <typename TakeMessage>
  [[nodiscard]] Result<void> take(std::string_view bytes, TakeMessage take_message) {
    Result<void> first;
    append(bytes);
    while (const auto message = next()) {
      Result<void> taken = take_message(*message);
      if (!taken && first) first = std::move(taken);
    }
    if (std::exchange(skipped_, 0) > 0 && first) {
      return input_failure({}, "the data do not begin with a message of the protocol");
    }
    return first;
  }
  void clear();

 private:
  void append(std::string_view bytes);
  // The next message, valid until the next call; nothing while incomplete.
  [[nodiscard]] std::optional<std::string_view> next();

  std::size_t header_size_;
  SizeOf size_of_;
  std::string waiting_;
  std::size_t taken_ = 0;
  std::size_t skipped_ = 0;  // Bytes that started no message.
};

}  // namespace retarget
