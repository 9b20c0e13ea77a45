#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "batch/batch_runner.h"
#include "batch/manifest.h"
#include "batch/resume.h"

namespace retarget {

/// The folders that outputs of these clips go to, that of the batch itself included.
[[nodiscard]] std::set<std::filesystem::path> output_folders(const std::string& folder,
                                                             const std::vector<BatchTask>& tasks);
/// The same as far as entries tell, of one robot or several.
[[nodiscard]] std::set<std::filesystem::path> output_folders(
    const std::string& folder, const std::vector<ManifestEntry>& entries);

/// Removes what a killed run left of outputs that were not whole; nobody else may be writing there.
/// Folders that links take out of the output folder are skipped.
void remove_unfinished(const std::string& output_folder,
                       const std::set<std::filesystem::path>& folders);

/// Files, below the output folder, that earlier options made of clips that are done again and that
/// the present ones neither replace nor list any more: those of another --format.
[[nodiscard]] std::vector<std::string> files_of_earlier_options(const std::string& folder,
                                                                const std::vector<BatchTask>& tasks,
                                                                const FinishedClips& finished);

}  // namespace retarget
