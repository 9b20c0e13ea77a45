#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace retarget {

/// Splits the bytes of a connection, or datagrams, into lines. Skips blank lines. Drops lines
/// longer than one megabyte and lines of a datagram beyond a maximum number.
class LineCutter {
 public:
  /// @param most  maximum number of lines per datagram
  explicit LineCutter(std::size_t most) : most_(most) {}

  /// Adds the next bytes. @pre next() has returned all earlier lines
  void add(std::string_view bytes);
  /// Adds the next datagram; its last line needs no line end.
  void add_datagram(std::string_view bytes);
  /// Ends the input: the remaining bytes are the last line.
  void end() { is_whole_ = true; }
  /// Returns the next line, valid until the next call.
  /// @return whether there was one.
  [[nodiscard]] bool next(std::string_view& line);
  void clear();

  /// Number of dropped lines.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  std::size_t most_;
  std::string waiting_;
  std::size_t taken_ = 0;   // Bytes already returned.
  std::size_t looked_ = 0;  // Bytes searched without a line end.
  std::size_t given_ = 0;   // Lines returned of this datagram.
  bool is_whole_ = false;   // The buffered bytes will not be continued.
  bool is_datagram_ = false;
  bool skips_ = false;  // Skip to the next line end.
  std::int64_t dropped_ = 0;
};

}  // namespace retarget
