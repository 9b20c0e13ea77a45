#pragma once

#include <string>

#include "retarget/error.h"

namespace retarget {

/// Checks a model's XML before MuJoCo reads it: MuJoCo trusts all sizes and counts, opens every
/// named file, and ends the process when memory runs out.
///
/// Rejects (kConfig, with line) files that are not regular files, `<include>`s and attached models
/// outside the model's folder, plugins, implausible sizes and counts (`<size>`, `<hfield>`,
/// `<replicate>`, `<composite>`, `<flexcomp>`, `<numeric>`), and texts or trees that are too large
/// including everything they include and repeat. Other errors are left to MuJoCo.
/// @param meshes  true if mesh files will be read: they must then be regular files in the model's
///   folder or, as in ROS packages, in its parent folder.
[[nodiscard]] Result<void> check_model(const std::string& path, bool meshes);

}  // namespace retarget
