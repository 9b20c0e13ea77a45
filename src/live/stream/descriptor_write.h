#pragma once

#include <sys/types.h>

#include <chrono>
#include <string_view>

#include "live/stream/socket.h"

namespace retarget {

/// The type of a descriptor, as far as it matters for writing.
enum class DescriptorKind : unsigned char {
  kFile,    ///< A regular file, which is always ready.
  kSocket,  ///< A socket.
  kOther,   ///< A pipe, a terminal or a device.
};

[[nodiscard]] DescriptorKind descriptor_kind(const Descriptor& descriptor);

/// Writes the first bytes of a text, as many as the descriptor accepts; waits at most the given
/// time for it to become ready. Also works on blocking descriptors.
/// @return number of bytes written; 0: not ready; negative: error, see errno.
[[nodiscard]] ssize_t write_within(const Descriptor& to, DescriptorKind kind,
                                   std::string_view bytes, std::chrono::milliseconds wait);

}  // namespace retarget
