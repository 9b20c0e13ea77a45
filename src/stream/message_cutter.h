#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace retarget {

/// Cuts the bytes of a connection into a protocol's messages, whose headers say how long they are.
class MessageCutter {
 public:
  /// The size of a message, header included, by the first bytes of it; nothing: none begins so.
  using SizeOf = std::optional<std::size_t> (*)(std::string_view header);

  /// @param header_size  bytes that size_of needs.
  MessageCutter(std::size_t header_size, SizeOf size_of)
      : header_size_(header_size), size_of_(size_of) {}

  /// Takes the next bytes.
  void append(std::string_view bytes);
  /// The next message, valid until the next call; nothing: it has not come whole.
  [[nodiscard]] std::optional<std::string_view> next();
  /// Bytes that began no message, since it was asked last.
  [[nodiscard]] std::size_t take_skipped();
  void clear();

 private:
  std::size_t header_size_;
  SizeOf size_of_;
  std::string waiting_;
  std::size_t taken_ = 0;
  std::size_t skipped_ = 0;
};

}  // namespace retarget
