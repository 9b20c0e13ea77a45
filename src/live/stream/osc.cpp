#include "live/stream/osc.h"

#include <bit>
#include <cstdint>

#include "retarget/bytes.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::string_view kBundle("#bundle\0", 8);
constexpr int kMaxDepth = 4;  // Nesting depth of bundles.
constexpr std::size_t kMaxBundledMessages = 1000;

Failure bad_osc(const char* what) {
  return input_failure({}, std::string("not an Open Sound Control packet: ") + what);
}

// Reads a packet from the front.
class OscReader {
 public:
  explicit OscReader(std::string_view bytes) : reader_(bytes) {}

  [[nodiscard]] bool empty() const { return reader_.left() == 0; }
  Result<std::string_view> bytes(std::size_t size) {
    const std::string_view taken = reader_.bytes(size);
    if (!reader_.ok()) return bad_osc("it is truncated");
    return taken;
  }
  // Reads a zero-terminated string, padded to a multiple of four bytes.
  Result<std::string_view> text() {
    const std::string_view taken = reader_.text();
    if (!reader_.ok()) return bad_osc("a string is not terminated");
    RETARGET_TRY(bytes(3 - taken.size() % 4));
    return taken;
  }
  template <typename Number>
  Result<Number> number() {
    const auto value = reader_.number<Number>();
    if (!reader_.ok()) return bad_osc("it is truncated");
    return value;
  }

 private:
  ByteReader<std::endian::big> reader_;
};

Result<void> read_argument(char type, OscReader& reader, OscMessage& message) {
  switch (type) {
    case 'i': {
      RETARGET_TRY_ASSIGN(const auto value, reader.number<std::int32_t>());
      message.numbers.push_back(value);
      return {};
    }
    case 'f': {
      RETARGET_TRY_ASSIGN(const auto value, reader.number<float>());
      message.numbers.push_back(static_cast<double>(value));
      return {};
    }
    case 'd': {
      RETARGET_TRY_ASSIGN(const auto value, reader.number<double>());
      message.numbers.push_back(value);
      return {};
    }
    case 's':
    case 'S': {
      RETARGET_TRY_ASSIGN(const std::string_view text, reader.text());
      message.texts.push_back(text);
      return {};
    }
    case 'h':
    case 't':
      RETARGET_TRY(reader.bytes(8));
      return {};
    case 'c':
    case 'r':
    case 'm':
      RETARGET_TRY(reader.bytes(4));
      return {};
    case 'b': {
      RETARGET_TRY_ASSIGN(const std::size_t size, reader.number<std::uint32_t>());
      RETARGET_TRY(reader.bytes((size + 3) / 4 * 4));
      return {};
    }
    case 'T':
    case 'F':
    case 'N':
    case 'I':
      return {};
    default:
      return bad_osc("unknown argument type");
  }
}

Result<void> read_packet(std::string_view packet, int depth, std::vector<OscMessage>& messages) {
  OscReader reader(packet);
  if (packet.starts_with(kBundle)) {
    if (depth == kMaxDepth) return bad_osc("bundles are nested too deeply");
    RETARGET_TRY(reader.bytes(kBundle.size() + 8));  // Includes the time tag.
    while (!reader.empty()) {
      RETARGET_TRY_ASSIGN(const auto size, reader.number<std::uint32_t>());
      RETARGET_TRY_ASSIGN(const std::string_view element, reader.bytes(size));
      RETARGET_TRY(read_packet(element, depth + 1, messages));
    }
    return {};
  }
  if (messages.size() == kMaxBundledMessages) return bad_osc("it has too many messages");
  OscMessage message;
  RETARGET_TRY_ASSIGN(message.address, reader.text());
  if (!message.address.starts_with('/')) return bad_osc("an address must begin with /");
  // Old senders omit the type tags if there are no arguments.
  if (!reader.empty()) {
    RETARGET_TRY_ASSIGN(const std::string_view types, reader.text());
    if (!types.starts_with(',')) return bad_osc("type tags must begin with a comma");
    for (const char type : types.substr(1)) RETARGET_TRY(read_argument(type, reader, message));
  }
  messages.push_back(std::move(message));
  return {};
}

// Appends a string with at least one zero, padded to a multiple of four bytes.
void append_text(std::string_view text, std::string& bytes) {
  bytes.append(text);
  bytes.append(4 - text.size() % 4, '\0');
}

}  // namespace

OscBundle::OscBundle() : bytes_(kBundle) {
  // The time tag for "immediately".
  append_big_endian(bytes_, 1, 8);
}

void OscBundle::add(std::string_view address, std::string_view types, std::string_view text,
                    std::span<const double> numbers) {
  std::string message;
  append_text(address, message);
  append_text("," + std::string(types), message);
  for (const char type : types) {
    if (type == 's') {
      append_text(text, message);
      continue;
    }
    const double number = numbers.front();
    numbers = numbers.subspan(1);
    if (type == 'i') {
      append_big_endian(message, static_cast<std::uint32_t>(static_cast<std::int32_t>(number)), 4);
    } else {
      append_big_endian(message, static_cast<float>(number));
    }
  }
  append_big_endian(bytes_, message.size(), 4);
  bytes_ += message;
}

Result<std::vector<OscMessage>> read_osc(std::string_view packet) {
  std::vector<OscMessage> messages;
  RETARGET_TRY(read_packet(packet, 0, messages));
  return messages;
}

}  // namespace retarget
