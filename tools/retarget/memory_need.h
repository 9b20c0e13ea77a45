#pragma once

#include <cstdint>
#include <string>

#include "options.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget::cli {

/// A robot's motion that is to be made, and of what.
struct MotionNeed {
  std::int64_t frames = 0;
  FrameRate rate;
  std::uint64_t file_bytes = 0;  ///< Of what it is made of.
  std::string file;              ///< The same, for messages.
  bool is_solved = true;         ///< From a human's, and measured; false: as it was read.
};

/// Whether the motion, and the files that the options make of it, can be held in memory: within what
/// the user allows (SourceOptions::memory_gb), and in proportion to the file that it is made of.
/// @return kInput error that says how much is needed, and which option helps.
[[nodiscard]] Result<void> check_need(const MotionNeed& need, const RunOptions& options);

}  // namespace retarget::cli
