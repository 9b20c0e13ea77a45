#include "live/stream/stream_address.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <string_view>

#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr std::array<std::pair<std::string_view, Transport>, 4> kSockets = {
    {{"udp", Transport::kUdp},
     {"tcp", Transport::kTcp},
     {"zmq", Transport::kZmq},
     {"redis", Transport::kRedis}}};

bool is_host(std::string_view text) {
  if (text == "localhost") return true;
  int parts = 0;
  for (std::size_t begin = 0; begin <= text.size(); ++parts) {
    const std::size_t end = std::min(text.find('.', begin), text.size());
    const auto part = parse_number<int>(text.substr(begin, end - begin));
    if (!part || *part < 0 || *part > 255) return false;
    begin = end + 1;
  }
  return parts == 4;
}

Result<void> parse_extras(std::string_view text, const std::string& whole, StreamAddress& address) {
  while (!text.empty()) {
    const std::string_view part = take_until(text, '&');
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos || equals == 0 || equals + 1 == part.size()) {
      return usage_failure(
          fmt::format("expected NAME=VALUE after ? in \"{}\", found \"{}\"", whole, part),
          "for example: udp:1118?format=bvh");
    }
    const std::string name(part.substr(0, equals)), value(part.substr(equals + 1));
    if (name == "format") {
      address.format = value;
    } else {
      address.extras.emplace_back(name, value);
    }
  }
  return {};
}

Result<void> parse_place(std::string_view place, const std::string& whole, StreamAddress& address) {
  constexpr int kMaxPort = 65535;
  const std::size_t colon = place.rfind(':');
  std::string_view port = place;
  if (colon != std::string_view::npos) {
    address.host = place.substr(0, colon);
    port = place.substr(colon + 1);
  }
  const auto number = parse_number<int>(port);
  if (!number || *number < 0 || *number > kMaxPort || !is_host(address.host)) {
    return usage_failure(
        fmt::format("expected a port from 0 to {}, optionally after an IPv4 address, found \"{}\"",
                    kMaxPort, whole),
        "for example: udp:1118 or udp:0.0.0.0:1118");
  }
  if (address.host == "localhost") address.host = "127.0.0.1";
  address.port = *number;
  return {};
}

}  // namespace

bool is_this_machine(const StreamAddress& address) {
  return address.host.starts_with("127.");
}

std::string StreamAddress::extra(const std::string& name) const {
  const auto found = std::ranges::find(extras, name, &std::pair<std::string, std::string>::first);
  return found == extras.end() ? std::string() : found->second;
}

std::string StreamAddress::text() const {
  switch (transport) {
    case Transport::kUdp:
      return fmt::format("udp:{}:{}", host, port);
    case Transport::kTcp:
      return fmt::format("tcp:{}:{}", host, port);
    case Transport::kZmq:
      return fmt::format("zmq:{}:{}", host, port);
    case Transport::kRedis:
      return fmt::format("redis:{}:{}", host, port);
    case Transport::kStdin:
      return "standard input";
    case Transport::kStdout:
      return "standard output";
    case Transport::kFile:
      break;
  }
  return file;
}

Result<StreamAddress> parse_address(const std::string& text) {
  StreamAddress address;
  const std::size_t question = std::min(text.find('?'), text.size());
  const std::string place = text.substr(0, question);
  if (question < text.size()) {
    RETARGET_TRY(parse_extras(std::string_view(text).substr(question + 1), text, address));
  }
  for (const auto& [name, transport] : kSockets) {
    if (!place.starts_with(fmt::format("{}:", name))) continue;
    address.transport = transport;
    RETARGET_TRY(parse_place(std::string_view(place).substr(name.size() + 1), text, address));
    return address;
  }
  if (place == "stdin") {
    address.transport = Transport::kStdin;
  } else if (place == "stdout" || place == "-") {
    address.transport = Transport::kStdout;
  } else if (place.empty()) {
    return usage_failure(fmt::format("\"{}\" is not a valid address", text), "as in udp:1118");
  } else {
    address.transport = Transport::kFile;
    address.file = place;
  }
  return address;
}

Result<void> check_extras(const StreamAddress& address, std::span<const std::string> known) {
  for (const auto& [name, value] : address.extras) {
    if (std::ranges::find(known, name) != known.end()) continue;
    std::vector<std::string> names(known.begin(), known.end());
    names.emplace_back("format");
    return usage_failure(fmt::format("{} has no option {}={}{}", address.text(), name, value,
                                     did_you_mean(name, names)));
  }
  return {};
}

std::string Endpoint::text() const {
  return fmt::format("{}.{}.{}.{}:{}", host >> 24, host >> 16 & 255, host >> 8 & 255, host & 255,
                     port);
}

Endpoint endpoint_of(const StreamAddress& address) {
  std::uint32_t host = 0, part = 0;
  for (const char c : address.host) {
    if (c == '.') {
      host = host << 8 | std::exchange(part, 0);
    } else {
      part = 10 * part + static_cast<std::uint32_t>(c - '0');
    }
  }
  return {host << 8 | part, static_cast<std::uint16_t>(address.port)};
}

}  // namespace retarget
