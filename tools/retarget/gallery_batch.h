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

/// A file that a manifest has a record of.
struct RecordedFile {
  std::string path;       ///< Where it is with the recorded size and hash; empty: nowhere.
  bool is_there = false;  ///< Whether there is a file of its name, perhaps with another content.
};

/// The source of an entry: below the working directory, else below the batch's folder.
[[nodiscard]] RecordedFile find_source(const BatchFolder& batch, const ManifestEntry& entry);

/// Whether there is a file of the source's name; it is not read.
[[nodiscard]] bool source_is_there(const BatchFolder& batch, const ManifestEntry& entry);

/// The motion of an entry.
[[nodiscard]] RecordedFile find_motion(const BatchFolder& batch, const ManifestEntry& entry);

/// How an entry's motion is measured and shown.
struct ShownEntry {
  ViewArguments arguments;
  std::string lacks;  ///< Why there is no source beside it, where one is there; empty: all is well.
};

/// Measures a motion without its source, and without what options say about that.
void forget_source(Run& run);

/// Its robot, its source, and of the batch's options those that say what was made of the source, how
/// the motion is measured and how its file was written. Sources and files of options are taken only
/// where they are what the batch read.
/// @param given        data folder and gates of the call take precedence,
/// @param given_robot  and its robot where the entry is of this name; empty: none was given.
[[nodiscard]] ShownEntry arguments_of(const BatchFolder& batch, const ManifestEntry& entry,
                                      const ViewArguments& given, const std::string& given_robot);

}  // namespace retarget::cli
