#pragma once

#include <string>

namespace retarget {

/// The MuJoCo that the library was built with and the one it runs with, such as `3.3.7`.
struct MujocoVersion {
  std::string header;
  std::string library;
  bool match = false;  ///< Models have another layout in every version, so both must be the same.
};

[[nodiscard]] MujocoVersion mujoco_version();

/// The version as text: MuJoCo's number has one digit for minor and patch up to 3.4.0 (`337`) and
/// three from 3.6.0 on (`3006000`).
[[nodiscard]] std::string mujoco_version_text(int number);

}  // namespace retarget
