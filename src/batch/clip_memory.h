#pragma once

#include <cstdint>
#include <string_view>

namespace retarget {

/// Bytes that a clip takes in memory while it is retargeted and measured, roughly.
/// @param file   of its motion; the ending says of what kind,
/// @param bytes  and how large it is.
[[nodiscard]] std::uint64_t memory_of_clip(std::string_view file, std::uint64_t bytes);

/// A process may take this beside what all clips may need together: the tool itself, and what an
/// estimate misses.
inline constexpr std::uint64_t kMemoryOfProcess = std::uint64_t{1} << 30U;

}  // namespace retarget
