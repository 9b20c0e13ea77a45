#pragma once

#include "live/stream/decoder.h"
#include "live/stream/stream_address.h"
#include "retarget/error.h"

namespace retarget {

/// Checks that a stream in a format can come from an address. Errors (kUsage): unsupported kind of
/// address; parameters after `?` that neither the transport nor the format supports, or with
/// invalid values.
[[nodiscard]] Result<void> check_input(const StreamAddress& from, const StreamFormat& format);

/// Checks that a motion can be played to an address. Errors: as above.
[[nodiscard]] Result<void> check_player_target(const StreamAddress& to, const StreamFormat& format);

}  // namespace retarget
