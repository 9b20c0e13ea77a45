#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "options.h"
#include "retarget/clip.h"

namespace retarget::cli {

/// A motion file as it was read.
struct SourceMotion {
  Clip clip;
  std::vector<Warning> warnings;  ///< Printed already.
  std::optional<double> height;   ///< Of the body, metres, where the file tells.
  std::uint64_t bytes = 0;        ///< Of the file.
};

/// The memory that may be taken, bytes: what the user allows, else three quarters of what there is.
/// 0: not known.
[[nodiscard]] std::uint64_t memory_bound(const SourceOptions& options);

/// The part of it that a motion's file may take; a clip, or an array, as well. No bound where none
/// is known.
[[nodiscard]] std::size_t memory_share(const SourceOptions& options);

/// Where a file was larger than its part: how it may have more.
void add_memory_hint(Error& error);

/// Error (kInput): the path is a folder; the hint names the command that takes folders.
[[nodiscard]] Result<void> check_no_folder(const std::string& path);

/// Reads the source clip and prints its warnings.
[[nodiscard]] Result<SourceMotion> read_source(const SourceOptions& options, bool skeleton_only,
                                               Console& console);

/// The source as it is named to people.
[[nodiscard]] std::string source_name(const SourceOptions& options);

}  // namespace retarget::cli
