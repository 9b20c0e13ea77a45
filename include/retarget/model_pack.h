#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/robots.h"

namespace RETARGET_API retarget {

/// Makes the pack of a robot: the compiled models of the robot and of its variants, which the
/// browser page reads instead of their XML (docs/browser.md). Equal files give equal bytes for one
/// version of MuJoCo.
/// Errors (kConfig): those of load_robot_files.
[[nodiscard]] Result<std::string> make_model_pack(const RobotFiles& files);

}  // namespace retarget
