#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "retarget/view.h"

namespace retarget {

/// A clip in a gallery. All texts may be any.
struct GalleryClip {
  std::string name;
  std::string robot;
  std::string page;     ///< Address of its page; empty: it has none.
  std::string picture;  ///< Address of its thumbnail; empty: none.
  int frames = 0;
  double fps = 30.0;
  bool failed = false;
  std::string message;    ///< Why it has no page, or its page no motion; empty: all is there.
  bool measured = false;  ///< Whether figures and gates are known.
  std::vector<std::pair<std::string, double>> figures;  ///< By metric.
  std::vector<std::string> missed;                      ///< Metrics whose gates were missed.
};

/// Of thumbnails, pixels.
inline constexpr double kThumbnailWidth = 320.0, kThumbnailHeight = 96.0;

/// The page that lists the clips of a batch, to be searched, sorted and filtered; one HTML file that
/// asks for nothing but the thumbnails beside it.
/// @param clips  the worst first.
[[nodiscard]] std::string gallery_page(const std::string& title,
                                       std::span<const GalleryClip> clips);

/// A clip's page where there is no motion to be played: why, and the way to the others.
[[nodiscard]] std::string gallery_note_page(const std::string& title, const std::string& message,
                                            const PageLinks& links);

}  // namespace retarget
