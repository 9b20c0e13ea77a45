#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "gallery_batch.h"

namespace retarget::cli {

/// Where the pages lie below a gallery's folder.
inline constexpr const char* kGalleryPages = "clips";

/// The name of a clip's page and picture without their endings: fit for an address, and the same
/// whenever the clip's and the robot's are.
[[nodiscard]] Result<std::string> gallery_name(const ManifestEntry& entry);

/// Whether a gallery may be put there: kUsage, it is no folder, or one that holds a manifest, or what
/// a batch made or was made from.
[[nodiscard]] Result<void> check_gallery_folder(const std::string& output,
                                                const BatchFolder& batch);

/// Removes pages and pictures that a former gallery made: files that gallery_name() could have named.
/// @param kept  names of those that stay.
void remove_stale_pages(const std::filesystem::path& pages, const std::set<std::string>& kept);

}  // namespace retarget::cli
