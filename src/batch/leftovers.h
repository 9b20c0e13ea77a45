#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/manifest.h"
#include "batch/resume.h"

namespace retarget {

/// The output folders of these clips, including the folder of the batch.
[[nodiscard]] std::set<std::filesystem::path> output_folders(const std::string& folder,
                                                             const std::vector<BatchTask>& tasks);
/// The same, derived from entries of one or several robots.
[[nodiscard]] std::set<std::filesystem::path> output_folders(
    const std::string& folder, const std::vector<ManifestEntry>& entries);

/// Removes unfinished outputs of a killed run. No other process may be writing there. Skips folders
/// that symbolic links place outside of the output folder.
void remove_unfinished(const std::string& output_folder,
                       const std::set<std::filesystem::path>& folders);

/// Files, relative to the output folder, that earlier options created for clips that are done
/// again, and that the current options neither replace nor list, such as files of another --format.
[[nodiscard]] std::vector<std::string> files_of_earlier_options(const std::string& folder,
                                                                const std::vector<BatchTask>& tasks,
                                                                const FinishedClips& finished);

}  // namespace retarget
