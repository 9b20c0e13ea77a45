#pragma once

#include <string>
#include <vector>

#include "edit/ground_path.h"
#include "human/human_clip.h"

namespace retarget {

/// A motion, and the path that it follows, as seen from above.
struct PathDrawing {
  const HumanClip* human = nullptr;
  const GroundPath* path = nullptr;
};

/// Motions seen from above as SVG: the track of the hips, the path with its control points, and
/// the feet where they stand (toes where there are any, left and right in colours of their own).
/// x goes to the right, y up; a scale is drawn. The first motion is drawn paler than those after it.
[[nodiscard]] std::string draw_paths(const std::vector<PathDrawing>& drawings);

}  // namespace retarget
