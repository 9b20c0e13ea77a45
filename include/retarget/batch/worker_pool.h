#pragma once

#include <cstdint>

namespace retarget {

/// The processors that this process may use.
[[nodiscard]] int usable_cores();

/// The memory that this process may use, bytes: the machine's, or less where its control group has
/// a limit. 0: not known.
[[nodiscard]] std::uint64_t usable_memory();

}  // namespace retarget
