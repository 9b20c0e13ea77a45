#pragma once

#include <cstddef>

namespace retarget {

/// Bytes of a file of settings (a retargeting configuration, a profile, gates, a path, a sidecar):
/// the largest there are have some hundred thousand. More are not read, as from a pipe without an
/// end.
inline constexpr std::size_t kMaxTextBytes = std::size_t{32} << 20U;

}  // namespace retarget
