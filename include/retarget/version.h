#pragma once

#include <string>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The version of this library and tool, `major.minor.patch`.
[[nodiscard]] std::string version_number();

/// The output of `--version`, one fact per line, no final newline: version and git commit (where
/// built from a git checkout), compiler and whether it compiled only for the build machine
/// (RETARGET_NATIVE), MuJoCo's header and library, Eigen.
///
///     retarget 0.1.0 (git 0123456789ab)
///     compiler GCC 12.2.0
///     MuJoCo 4.0.0 (compiled against 4.0.0)
///     Eigen 3.4.0
[[nodiscard]] std::string version_text();

}  // namespace retarget
