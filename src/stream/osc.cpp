#include "stream/osc.h"

#include <bit>
#include <cstdint>

#include "base/byte_order.h"
#include "base/try.h"

namespace retarget {
namespace {

constexpr std::string_view kBundle("#bundle\0", 8);
constexpr int kMaxDepth = 4;  // of bundles in bundles

Failure bad_osc(const char* what) {
  return input_failure({}, std::string("no packet of Open Sound Control: ") + what);
}

// reads a packet from its beginning
class OscReader {
 public:
  explicit OscReader(std::string_view bytes) : reader_(bytes) {}

  [[nodiscard]] bool empty() const { return reader_.left() == 0; }
  Result<std::string_view> bytes(std::size_t size) {
    const std::string_view taken = reader_.bytes(size);
    if (!reader_.ok()) return bad_osc("it ends too early");
    return taken;
  }
  // ended by a zero, filled up to a whole number of four bytes
  Result<std::string_view> text() {
    const std::string_view taken = reader_.text();
    if (!reader_.ok()) return bad_osc("a text without an end");
    TRY(bytes(3 - taken.size() % 4));
    return taken;
  }
  template <typename Number>
  Result<Number> number() {
    const auto value = reader_.number<Number>();
    if (!reader_.ok()) return bad_osc("it ends too early");
    return value;
  }

 private:
  ByteReader<std::endian::big> reader_;
};

Result<void> read_argument(char type, OscReader& reader, OscMessage& message) {
  switch (type) {
    case 'i': {
      TRY_ASSIGN(const auto value, reader.number<std::int32_t>());
      message.numbers.push_back(value);
      return {};
    }
    case 'f': {
      TRY_ASSIGN(const auto value, reader.number<float>());
      message.numbers.push_back(static_cast<double>(value));
      return {};
    }
    case 'd': {
      TRY_ASSIGN(const auto value, reader.number<double>());
      message.numbers.push_back(value);
      return {};
    }
    case 's':
    case 'S': {
      TRY_ASSIGN(const std::string_view text, reader.text());
      message.texts.push_back(text);
      return {};
    }
    case 'h':
    case 't':
      TRY(reader.bytes(8));
      return {};
    case 'c':
    case 'r':
    case 'm':
      TRY(reader.bytes(4));
      return {};
    case 'b': {
      TRY_ASSIGN(const std::size_t size, reader.number<std::uint32_t>());
      TRY(reader.bytes((size + 3) / 4 * 4));
      return {};
    }
    case 'T':
    case 'F':
    case 'N':
    case 'I':
      return {};
    default:
      return bad_osc("an argument of a type that it does not have");
  }
}

Result<void> read_packet(std::string_view packet, int depth, std::vector<OscMessage>& messages) {
  OscReader reader(packet);
  if (packet.starts_with(kBundle)) {
    if (depth == kMaxDepth) return bad_osc("bundles in bundles in bundles");
    TRY(reader.bytes(kBundle.size() + 8));  // and when it should count
    while (!reader.empty()) {
      TRY_ASSIGN(const auto size, reader.number<std::uint32_t>());
      TRY_ASSIGN(const std::string_view element, reader.bytes(size));
      TRY(read_packet(element, depth + 1, messages));
    }
    return {};
  }
  OscMessage message;
  TRY_ASSIGN(message.address, reader.text());
  if (!message.address.starts_with('/')) return bad_osc("an address begins with /");
  // old senders leave the types out where there are no arguments
  if (!reader.empty()) {
    TRY_ASSIGN(const std::string_view types, reader.text());
    if (!types.starts_with(',')) return bad_osc("types begin with a comma");
    for (const char type : types.substr(1)) TRY(read_argument(type, reader, message));
  }
  messages.push_back(std::move(message));
  return {};
}

// ended by a zero at least, filled up to a whole number of four bytes
void append_text(std::string_view text, std::string& bytes) {
  bytes.append(text);
  bytes.append(4 - text.size() % 4, '\0');
}

}  // namespace

OscBundle::OscBundle() : bytes_(kBundle) {
  // the time that stands for "at once"
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
  TRY(read_packet(packet, 0, messages));
  return messages;
}

}  // namespace retarget
