#pragma once

#include <string>

namespace retarget {

/// `major.minor.patch` of MuJoCo's version number, which has three digits up to 3.4.0 (`340`) and
/// seven from 3.6.0 on (`3006000`).
[[nodiscard]] std::string mujoco_version_text(int number);

}  // namespace retarget
