#pragma once

#include <cstdint>
#include <string>

namespace retarget {

/// Where the system tells of control groups.
struct ControlGroupFiles {
  std::string root = "/sys/fs/cgroup";
  std::string membership = "/proc/self/cgroup";  ///< The groups that this process is in.
};

/// The processors that this process may use: the machine's, fewer where its affinity or the time
/// of its control group (both versions), rounded up, leave fewer.
[[nodiscard]] int usable_cores(const ControlGroupFiles& files = {});

/// The memory that this process may use, bytes: the machine's, or less where its control group has
/// a limit. 0: not known.
[[nodiscard]] std::uint64_t usable_memory(const ControlGroupFiles& files = {});

}  // namespace retarget
