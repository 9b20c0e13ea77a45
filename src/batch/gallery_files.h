#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "batch/gallery_batch.h"

namespace retarget {

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
