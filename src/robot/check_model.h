#pragma once

#include <string>

#include "retarget/error.h"

namespace retarget {

/// Looks a model's XML through before MuJoCo does, which takes sizes and counts at their word, opens
/// whatever is named, and ends the process where memory ends.
///
/// Refused (kConfig, with line): what is no regular file, `<include>`s and attached models outside
/// the model's folder, plugins, sizes and counts that no robot has (`<size>`, `<hfield>`,
/// `<replicate>`, `<composite>`, `<flexcomp>`, `<numeric>`), and texts or trees that are too large
/// with all that they include and repeat. What is merely wrong is left to MuJoCo to say.
/// @param meshes  whether mesh files are going to be read: they must be regular files in the folder
///                of the model or, as packages have it, in that above.
[[nodiscard]] Result<void> check_model(const std::string& path, bool meshes);

}  // namespace retarget
