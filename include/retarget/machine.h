#pragma once

#include <cstdint>
#include <string>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Files in which Linux describes control groups (cgroups).
struct ControlGroupFiles {
  std::string root = "/sys/fs/cgroup";
  std::string membership = "/proc/self/cgroup";  ///< The groups of this process.
};

/// The number of processors available to this process: those of the machine, limited by the CPU
/// affinity and by the CPU quota of the control group (v1 or v2), rounded up.
[[nodiscard]] int usable_cores(const ControlGroupFiles& files = {});

/// The memory available to this process in bytes: that of the machine, limited by the control
/// group. 0: unknown.
[[nodiscard]] std::uint64_t usable_memory(const ControlGroupFiles& files = {});

}  // namespace retarget
