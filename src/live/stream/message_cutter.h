#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

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

/// Splits bytes into consecutive JSON objects, plain or each in an LZ4 frame. The bytes may arrive
/// in chunks, as from a connection.
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

using PacketJson = nlohmann::json;

/// Parses the JSON of a packet from an untrusted sender. Rejects expensive input before parsing:
/// packets of more than a megabyte, with more than 20,000 values and names, or nested more than 32
/// deep are errors (kInput), as is invalid JSON. Of members with the same name the last one is
/// used.
/// @param what  for messages: `the line`
[[nodiscard]] Result<PacketJson> parse_packet_json(std::string_view text, const std::string& what);

/// The same for a line that must be an object.
[[nodiscard]] Result<PacketJson> parse_json_line(std::string_view line);

/// The first member of an object with one of these names and a value; null: none.
[[nodiscard]] const PacketJson* find_member(const PacketJson& json,
                                            std::initializer_list<const char*> names);

}  // namespace retarget
