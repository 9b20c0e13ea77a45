#pragma once

#include <cstdint>
#include <string_view>

namespace retarget {

/// Estimates the memory in bytes that a clip needs while it is retargeted and measured.
/// @param file   motion file; its extension determines the kind.
/// @param bytes  size of the file.
[[nodiscard]] std::uint64_t memory_of_clip(std::string_view file, std::uint64_t bytes);

/// Memory of a process beyond the estimates of its clips: the tool itself and estimation errors.
inline constexpr std::uint64_t kMemoryOfProcess = std::uint64_t{1} << 30U;

}  // namespace retarget
