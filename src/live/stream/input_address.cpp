#include "live/stream/input_address.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "retarget/try.h"

namespace retarget {
namespace {

// Parameters after `?` of a transport, regardless of the format.
std::vector<std::string> transport_extras(const StreamAddress& from, const StreamFormat& format) {
  if (from.transport == Transport::kTcp) return {"from"};
  if (from.transport != Transport::kUdp) return {};
  std::vector<std::string> names = {"from", "multicast"};
  if (format.request_port > 0) names.insert(names.end(), {"server", "command"});
  return names;
}

Result<void> check_values(const StreamAddress& from, const StreamFormat& format) {
  for (const StreamExtra& extra : format.extras) {
    const std::string value = from.extra(std::string(extra.name));
    if (value.empty() || extra.is_valid(value)) continue;
    return usage_failure(
        fmt::format("expected {}={}, found \"{}\"", extra.name, extra.expected, value));
  }
  return {};
}

}  // namespace

Result<void> check_input(const StreamAddress& from, const StreamFormat& format) {
  if (from.transport != Transport::kStdin && from.transport != Transport::kUdp &&
      from.transport != Transport::kTcp) {
    return usage_failure("an input must be udp:PORT, tcp:PORT or stdin, found " + from.text());
  }
  if (format.request_port == 0 && !from.extra("server").empty()) {
    return usage_failure("senders of this format have no server: remove ?server=");
  }
  std::vector<std::string> known = transport_extras(from, format);
  for (const StreamExtra& extra : format.extras) known.emplace_back(extra.name);
  RETARGET_TRY(check_extras(from, known));
  return check_values(from, format);
}

Result<void> check_player_target(const StreamAddress& to, const StreamFormat& format) {
  std::vector<std::string> known;
  if (to.transport == Transport::kUdp) known.emplace_back("interface");
  if (to.transport == Transport::kUdp && format.request_port > 0) known.emplace_back("command");
  return check_extras(to, known);
}

}  // namespace retarget
