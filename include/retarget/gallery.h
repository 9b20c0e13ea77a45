#pragma once

#include <functional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/run.h"

// Link retarget::batch.
namespace RETARGET_API retarget {

/// A gallery: pages of all motions of a batch, and an index page.
struct GalleryRequest {
  std::string batch;   ///< Output folder of a batch, which may still be running.
  std::string output;  ///< Folder of the gallery.
  DataFolder data_folder;
  /// A robot of the batch to load with these options instead of by its recorded name; empty: none.
  RobotChoice robot;
  std::vector<std::string> gates;  ///< Gates; see changed_gates().
  std::string meshes;  ///< Source of meshes, see load_robot_meshes; empty: the pages have no
                       ///< meshes, which keeps them small.
  OptionSpelling spelling = option_as_field;  ///< Spelling of options in texts of the pages.
  /// Called first in each worker process.
  std::function<void()> begin_worker;
};

/// Makes a gallery. Every motion gets a page with its metrics, and with its source if the source is
/// unchanged. Worker processes make the pages, so the caller must have no other threads. The index
/// is written last: an interrupted gallery has no new index. Pages of an earlier gallery in the
/// folder that are no longer linked are removed.
///
/// Errors: a folder without a manifest (kInput); an output that is the folder of a batch or
/// contains its files, a robot that is not in the batch (kUsage); kRun; kInterrupted.
[[nodiscard]] Result<void> write_gallery(const GalleryRequest& request, Observer& observer);

}  // namespace retarget
