#pragma once

#include <string>

#include "arguments.h"
#include "console.h"
#include "retarget/clip.h"

namespace retarget::cli {

/// Returns true if a file name ends in .glb, ignoring case.
[[nodiscard]] bool is_glb_name(const std::string& path);

/// Writes a human's motion as a GLB for viewing, in metres and upright, and prints how the human
/// was recognised.
[[nodiscard]] Result<void> save_human_glb(const std::string& output, Clip clip,
                                          const HumanOptions& human, const CommonArguments& common,
                                          Console& console);

}  // namespace retarget::cli
