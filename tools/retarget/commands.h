#pragma once

#include <string>

#include "console.h"
#include "options.h"
#include "retarget/bvh/read_bvh.h"

namespace retarget::cli {

/// Each command does its work and gives the exit code of the process.
[[nodiscard]] ExitCode run(const RunOptions& options, Console& console);
[[nodiscard]] ExitCode inspect(const InspectOptions& options, Console& console);

/// Reads the source clip and prints its warnings.
[[nodiscard]] Result<BvhFile> read_source(const SourceOptions& options, bool skeleton_only,
                                          Console& console);

/// The source as it is named to people.
[[nodiscard]] std::string source_name(const SourceOptions& options);

}  // namespace retarget::cli
