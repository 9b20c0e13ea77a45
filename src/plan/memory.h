#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// The memory that may be taken, bytes: what the user allows (SourceOptions::memory_gb), else three
/// quarters of what there is. 0: not known.
[[nodiscard]] std::uint64_t memory_bound(double memory_gb);

/// The part of it that a motion's file may take; a clip, or an array, as well. No bound where none
/// is known.
[[nodiscard]] std::size_t memory_share(double memory_gb);

/// A robot's motion that is to be made, and of what.
struct MotionNeed {
  std::int64_t frames = 0;
  FrameRate rate;
  std::uint64_t file_bytes = 0;  ///< Of what it is made of.
  std::string file;              ///< The same, for messages.
  bool is_solved = true;         ///< From a human's, and measured; false: as it was read.
};

/// Whether the motion, and the files that are made of it, can be held in memory: within what the user
/// allows, and in proportion to the file that it is made of.
/// @return kInput error that says how much is needed, and which option helps.
[[nodiscard]] Result<void> check_need(const MotionNeed& need, double memory_gb,
                                      const SaveOptions& save);

}  // namespace retarget
