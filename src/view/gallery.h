#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "retarget/view.h"

namespace retarget {

/// A clip in a gallery. Texts need no escaping.
struct GalleryClip {
  std::string name;
  std::string robot;
  std::string page;     ///< URL of its page; empty: none.
  std::string picture;  ///< URL of its thumbnail; empty: none.
  int frames = 0;
  double fps = 30.0;
  bool failed = false;
  std::string message;    ///< Why the page or its motion is missing; empty: complete.
  bool measured = false;  ///< True if metrics and gates are known.
  std::vector<std::pair<std::string, double>> figures;  ///< Values by metric.
  std::vector<std::string> missed;                      ///< Metrics that missed their gates.
};

/// Size of thumbnails, pixels.
inline constexpr double kThumbnailWidth = 320.0, kThumbnailHeight = 96.0;

/// Returns the page that lists the clips of a batch, with search, sorting and filters: one HTML
/// file that loads nothing except the thumbnails next to it.
/// @param clips  sorted, worst first.
[[nodiscard]] std::string gallery_page(const std::string& title,
                                       std::span<const GalleryClip> clips);

/// Returns the page for a clip without a playable motion: the reason, and links to the other clips.
[[nodiscard]] std::string gallery_note_page(const std::string& title, const std::string& message,
                                            const PageLinks& links);

}  // namespace retarget
