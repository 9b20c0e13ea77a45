#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/error.h"
#include "retarget/gallery.h"
#include "retarget/measure_files.h"

namespace retarget {

/// Contents of a batch's output folder.
struct BatchFolder {
  std::string folder;
  std::vector<ManifestEntry> entries;  ///< The last entry of each clip and robot.
  int unreadable = 0;                  ///< Number of truncated or invalid manifest lines.
  std::map<std::string, nlohmann::ordered_json> options;  ///< Options by hash.
};

/// Reads all manifests of a folder, including those of parts, and its options. The batch may still
/// be running or have been interrupted. Errors (kInput): no manifest exists.
[[nodiscard]] Result<BatchFolder> read_batch_folder(const std::string& folder);

/// Returns the motion file of an entry in a format that can be read back; empty: none.
[[nodiscard]] std::string motion_of(const BatchFolder& batch, const ManifestEntry& entry);

/// A file that a manifest has recorded.
struct RecordedFile {
  std::string path;       ///< Location with the recorded size and hash; empty: not found.
  bool is_there = false;  ///< True if a file of that name exists, with any content.
};

/// Returns true if a file of the source's name exists; does not read it.
[[nodiscard]] bool source_is_there(const BatchFolder& batch, const ManifestEntry& entry);

[[nodiscard]] RecordedFile find_motion(const BatchFolder& batch, const ManifestEntry& entry);

/// Options for measuring and showing an entry's motion.
struct ShownEntry {
  MeasureRequest request;
  std::string label;  ///< Label of the motion on its page.
  std::string lacks;  ///< Why an existing source is not shown; empty: no problem.
};

/// Removes the source from a run, and the options that concern it.
void forget_source(Run& run);

/// Data for showing an entry: its robot, its source, and the batch options that describe how the
/// source was processed, how the motion is measured and how its file was written. Sources and
/// option files are used only if they match the batch's record.
/// @param given        the gallery; its data folder and gates take precedence.
/// @param given_robot  name of the gallery's robot, which takes precedence for entries of that
///   name; empty: none.
[[nodiscard]] ShownEntry show_entry(const BatchFolder& batch, const ManifestEntry& entry,
                                    const GalleryRequest& given, const std::string& given_robot);

/// Subfolder of a gallery that holds the pages.
inline constexpr const char* kGalleryPages = "clips";

/// Returns the name of a clip's page and picture without extension: safe in URLs, and determined by
/// the clip and the robot alone.
[[nodiscard]] Result<std::string> gallery_name(const ManifestEntry& entry);

/// Checks that a gallery may be written to a folder. Errors (kUsage): it is not a folder, holds a
/// manifest, or contains outputs or inputs of a batch.
[[nodiscard]] Result<void> check_gallery_folder(const std::string& output,
                                                const BatchFolder& batch);

/// Removes pages and pictures of an earlier gallery: files that gallery_name() could have named.
/// @param kept  names of files to keep.
void remove_stale_pages(const std::filesystem::path& pages, const std::set<std::string>& kept);

}  // namespace retarget
