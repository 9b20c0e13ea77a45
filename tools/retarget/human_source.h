#pragma once

#include <filesystem>

#include "console.h"
#include "human/bone_map.h"
#include "human/calibrate.h"
#include "options.h"
#include "read_source.h"

namespace retarget::cli {

/// The human in a clip: which joints are its bones, and how it becomes the canonical human.
struct HumanSource {
  BoneMap map;
  Calibration calibration;
};

/// Recognises and measures the human of a whole clip, before any part of it is cut out.
/// @param dialects  folder of the dialect files.
[[nodiscard]] Result<HumanSource> find_human(SourceMotion& motion, const SourceOptions& source,
                                             const HumanOptions& options,
                                             const std::filesystem::path& dialects);

/// What can be told of the options without a clip: wrong values are kUsage errors, files that
/// cannot be read kConfig.
[[nodiscard]] Result<void> check_human_options(const HumanOptions& options);

}  // namespace retarget::cli
