#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

using PacketJson = nlohmann::json;

/// Parses the JSON of a packet from an untrusted sender. Rejects expensive input before parsing:
/// packets of more than a megabyte, with more than 20,000 values and names, or nested more than 32
/// deep are errors (kInput), as is invalid JSON. Of members with the same name the last one is
/// used.
/// @param what  for messages: `the line`
[[nodiscard]] Result<PacketJson> parse_packet_json(std::string_view text, const std::string& what);

}  // namespace retarget
