#pragma once

#include <string>

#include "arguments.h"
#include "console.h"
#include "retarget/clip.h"

namespace retarget::cli {

/// Whether a file's name says that it is a GLB, in any letter case.
[[nodiscard]] bool is_glb_name(const std::string& path);

/// Writes a human's motion as a GLB that shows it, in metres and upright as the human in it is
/// understood; says how.
[[nodiscard]] Result<void> save_human_glb(const std::string& output, Clip clip,
                                          const HumanOptions& human, const CommonArguments& common,
                                          Console& console);

}  // namespace retarget::cli
