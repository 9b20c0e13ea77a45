#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "arguments.h"
#include "batch/manifest.h"

namespace retarget::cli {

/// What the output folder of a batch says of itself.
struct BatchFolder {
  std::string folder;
  std::vector<ManifestEntry> entries;  ///< The last of each clip and robot.
  int unreadable = 0;                  ///< Lines of manifests that are torn or no entries.
  std::map<std::string, nlohmann::ordered_json> options;  ///< By their hash.
};

/// Reads all manifests of a folder, those of parts included, and its options. A batch may still run, or
/// have been stopped. Errors (kInput): there is no manifest.
[[nodiscard]] Result<BatchFolder> read_batch_folder(const std::string& folder);

/// The motion's file of an entry, one that can be read back; empty: it has none.
[[nodiscard]] std::string motion_of(const BatchFolder& batch, const ManifestEntry& entry);

/// How an entry's motion is measured and shown: its robot, its source where that is still there, and
/// of the batch's options those that say what was made of the source.
/// @param given  robot, data folder and gates of the call take precedence.
[[nodiscard]] ViewArguments arguments_of(const BatchFolder& batch, const ManifestEntry& entry,
                                         const ViewArguments& given);

}  // namespace retarget::cli
